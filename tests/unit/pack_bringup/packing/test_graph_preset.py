"""A preset reaches the nodes as parameters."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from pack_bringup.graph.graph import preset_overrides
from pack_bringup.packing.goals import NODES, packing_fill_job
from pack_core.errors import ConfigError
from pack_core.packing.cell import Perception, packing_cell
from pack_lockstep.packing.lockstep_config import load_preset


def value_of(overrides: dict[str, dict[str, str]], node: str, parameter: str) -> object:
    return yaml.safe_load(overrides[node][parameter])


def test_every_node_of_the_cell_is_told_of_the_same_cell() -> None:
    overrides, preset = preset_overrides("packing", "hardware"), load_preset("hardware")
    for node in NODES:
        text = value_of(overrides, node, "cell")
        assert isinstance(text, str)
        assert packing_cell(text) == preset.packing_cell() != packing_cell()


def test_nested_keys_become_dotted_parameters_with_their_values() -> None:
    overrides = preset_overrides("packing", "hardware")
    mismatch = load_preset("hardware").sim["mismatch"]
    assert value_of(overrides, "sim", "mismatch.friction") == mismatch["friction"]
    assert value_of(overrides, "mpc", "task.force_stop") == 40.0
    assert value_of(preset_overrides("packing", "ideal"), "mpc", "task.force_stop") == float("inf")


def test_the_recorder_notes_the_presets_name() -> None:
    assert value_of(preset_overrides("packing", "hardware"), "recorder", "preset") == "hardware"


def test_values_are_single_lines_for_the_command_line() -> None:
    for parameters in preset_overrides("packing", "hardware").values():
        assert not [text for text in parameters.values() if "\n" in text]


def test_no_preset_changes_nothing() -> None:
    assert preset_overrides("packing", "") == {}


@pytest.mark.parametrize(
    ("cell", "name", "error"),
    [
        ("packing", "perfect", "no preset 'perfect'; allowed: .*hardware"),
        ("blocks", "hardware", "no presets"),
    ],
)
def test_what_is_not_there_is_refused(cell: str, name: str, error: str) -> None:
    with pytest.raises(ConfigError, match=error):
        preset_overrides(cell, name)


def test_depth_cameras_reach_simulator_and_perception() -> None:
    overrides = preset_overrides("packing", "unknown")
    assert value_of(overrides, "perception", "depth.objects") == "unknown"
    for node in NODES:
        cell = value_of(overrides, node, "cell")
        assert isinstance(cell, str)
        assert packing_cell(cell).perception is Perception.DEPTH


def test_a_list_is_packed_with_depth_cameras_as_well(tmp_path: Path) -> None:
    job = packing_fill_job(0, None, folder=tmp_path, preset="unknown", real_time_factor=None, command="")
    assert value_of(job.overrides(), "perception", "depth.objects") == "unknown"
