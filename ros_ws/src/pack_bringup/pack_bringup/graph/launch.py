"""What the arguments of the launch file mean for a cell: settings, parameters, keys of the nodes (SROS 2)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, get_args

from pack_bringup.graph.graph import conditions, load_graph, parse_overrides
from pack_bringup.recording.run_record import Record
from pack_core.config import merged
from pack_core.errors import ConfigError
from pack_core.namespace import ROOT
from pack_core.text.yaml_text import parse_yaml

SCENE_PARAMETERS = {"packing": "sim.scene", "blocks": "sim.problem"}
"""The parameter that takes a file with what stands in the cell, by cell."""
SEEDED = ("packing", "palletizing")
"""Cells whose simulator draws something from a seed."""
YES, NO = "true", "false"


def launch_settings(cell: str, arguments: Mapping[str, str]) -> list[str]:
    """Settings `node.parameter=value` from `seed`, `scene` and `record`; empty ones are left out.

    Raises:
        ConfigError: the cell has no such argument, or not this value.
    """
    settings = []
    if seed := arguments.get("seed", ""):
        if cell not in SEEDED:
            raise ConfigError(
                f"seed:={seed}: cell '{cell}' has no seed; cells that have: {', '.join(SEEDED)}"
            )
        settings.append(f"sim.seed={seed}")
    if scene := arguments.get("scene", ""):
        if cell not in SCENE_PARAMETERS:
            raise ConfigError(
                f"scene:={scene}: cell '{cell}' has no scene file; cells that have: "
                f"{', '.join(SCENE_PARAMETERS)}; the palletizing cell takes order:="
            )
        settings.append(f"{SCENE_PARAMETERS[cell]}={scene}")
    if record := arguments.get("record", ""):
        if record not in get_args(Record):
            raise ConfigError(f"record:={record}; allowed: {', '.join(get_args(Record))}")
        settings.append(f"recorder.record={record}")
    return settings


def order_command(cell: str, order: str, namespace: str = ROOT) -> list[str]:
    """The command that sends the palletizing cell an order once it is up; empty where none is given.

    Raises:
        ConfigError: another cell was given an order.
    """
    if not order:
        return []
    if cell != "palletizing":
        raise ConfigError(f"order:={order}: only the cell 'palletizing' takes orders, not '{cell}'")
    where = [] if namespace == ROOT else ["--namespace", namespace]
    return ["pack", "goal", "palletizing", "--order", order, *where]


def is_yes(name: str, value: str) -> bool:
    """Whether a switch is on.

    Raises:
        ConfigError: the value is neither true nor false.
    """
    if value not in (YES, NO):
        raise ConfigError(f"{name}:={value}; allowed: {YES}, {NO}")
    return value == YES


def launch_parameters(
    cell: str, preset: str, settings: Iterable[str], calibration: str = ""
) -> dict[str, dict[str, Any]]:
    """What goes over the parameter files when a cell starts, by node and parameter, as values.

    Args:
        cell: one of the register's cells.
        preset: name of a file of config/presets/<cell>; empty: none.
        settings: `node.parameter=value` each; they go over the preset.
        calibration: a file that was made under this preset; empty: none.

    Raises:
        PackError: there is no such cell, preset or node, the cell takes no calibration or not this one, or a
            setting is not of that form.
    """
    graph = load_graph(cell)
    known = conditions(cell, preset, Path(calibration) if calibration else None)
    given = merged(known, parse_overrides(settings))
    graph.check_names(given)
    return {
        node.name: {
            "use_sim_time": node.use_sim_time,
            **{
                name: parse_yaml(text, f"{node.name}.{name}")
                for name, text in given.get(node.name, {}).items()
            },
        }
        for node in graph.nodes
    }


ENCLAVES = "enclaves"
"""Folder of a keystore that has a folder for every enclave."""


def security_environment(keystore: str) -> dict[str, str]:
    """Environment variables with which every node needs a key of a keystore; none where no keystore is given.

    Raises:
        ConfigError: there is no keystore.
    """
    if not keystore:
        return {}
    path = Path(keystore).expanduser().resolve()
    if not (path / ENCLAVES).is_dir():
        raise ConfigError(f"keystore:={keystore}: no keystore there; tools/keystore.sh CELL DIR makes one")
    return {
        "ROS_SECURITY_KEYSTORE": str(path),
        "ROS_SECURITY_ENABLE": "true",
        "ROS_SECURITY_STRATEGY": "Enforce",  # without a key a node does not start
    }


def enclave_arguments(keystore: str, cell: str, node: str) -> list[str]:
    """ROS arguments that give a node its key; none where no keystore is given.

    Raises:
        ConfigError: the keystore has no key for the node.
    """
    if not keystore:
        return []
    enclave = f"/packcell/{cell}/{node}"
    if not Path(keystore).expanduser().joinpath(ENCLAVES, enclave[1:]).is_dir():
        raise ConfigError(
            f"keystore:={keystore}: no key {enclave}; tools/keystore.sh {cell} {keystore} makes it"
        )
    return ["--enclave", enclave]
