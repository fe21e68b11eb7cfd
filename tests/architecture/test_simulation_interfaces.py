"""The pause's messages have the fields of simulation_interfaces 2.1.0, as far as they go."""

from __future__ import annotations

import importlib
import re
import sys
from types import ModuleType

import pytest
from pack_interfaces.msg import SimulationResult

from pack_core.paths import project_root
from pack_core.ros import simulation_types

FOLDER = project_root() / "ros_ws" / "src" / "pack_interfaces"
PARTS = {"SimulationResult": "Result"}
"""Our name of a part, where the package has another one."""
PUBLISHED = {
    "msg/SimulationResult.msg": ("uint8 result", "string error_message"),
    "msg/SimulationState.msg": ("uint8 state",),
    "srv/GetSimulationState.srv": ("---", "SimulationState state", "Result result"),
    "srv/SetSimulationState.srv": ("SimulationState state", "---", "Result result"),
}
"""Fields in their order, of Result.msg, SimulationState.msg and the services of these names, as published in
the repository ros-simulation/simulation_interfaces at the tag 2.1.0."""
CODES = {
    "msg/SimulationResult.msg": {
        "FEATURE_UNSUPPORTED": 0, "OK": 1, "NOT_FOUND": 2, "INCORRECT_STATE": 3, "OPERATION_FAILED": 4,
    },
    "msg/SimulationState.msg": {
        "STATE_STOPPED": 0, "STATE_PLAYING": 1, "STATE_PAUSED": 2, "STATE_QUITTING": 3,
    },
    "srv/SetSimulationState.srv": {
        "ALREADY_IN_TARGET_STATE": 101, "STATE_TRANSITION_ERROR": 102, "INCORRECT_TRANSITION": 103,
    },
}  # fmt: skip
"""Constants, of which 2.1.0 has two states more, for worlds, which are no feature here."""


def statements(file: str) -> list[str]:
    """The lines of a definition without comments and blanks."""
    lines = (line.partition("#")[0].strip() for line in (FOLDER / file).read_text().splitlines())
    return [re.sub(r"\s+", " ", line) for line in lines if line]


@pytest.mark.parametrize("file", PUBLISHED)
def test_fields_are_those_that_are_published_in_their_order(file: str) -> None:
    found = [line for line in statements(file) if "=" not in line]
    assert [" ".join(PARTS.get(word, word) for word in line.split()) for line in found] == list(
        PUBLISHED[file]
    )


@pytest.mark.parametrize("file", CODES)
def test_constants_have_the_published_values(file: str) -> None:
    found = dict(line.removeprefix("uint8 ").split("=") for line in statements(file) if "=" in line)
    assert {name.strip().removeprefix("RESULT_"): int(value) for name, value in found.items()} == CODES[file]


def test_types_of_a_distribution_s_package_are_taken_where_it_is_installed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert simulation_types.Result is SimulationResult, "the wheels of ROS 2 have no such package"
    theirs = {"msg": ("Result", "SimulationState"), "srv": ("GetSimulationState", "SetSimulationState")}
    for kind, names in theirs.items():
        module = ModuleType(f"simulation_interfaces.{kind}")
        for name in names:
            setattr(module, name, type(name, (), {}))
        monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setitem(sys.modules, "simulation_interfaces", ModuleType("simulation_interfaces"))
    try:
        taken = importlib.reload(simulation_types)
        for kind, names in theirs.items():
            module = sys.modules[f"simulation_interfaces.{kind}"]
            assert all(getattr(taken, name) is getattr(module, name) for name in names)
    finally:
        monkeypatch.undo()
        importlib.reload(simulation_types)
    assert simulation_types.Result is SimulationResult
