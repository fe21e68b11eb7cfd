"""`pack benchmark palletizing --shift` takes no option that would have no effect."""

from pathlib import Path

import pytest

from pack_bringup.palletizing.goals import LiveShiftJob
from pack_bringup.palletizing.shift_command import refuse
from pack_core.errors import ConfigError


def test_options_for_orders_are_named() -> None:
    with pytest.raises(ConfigError, match=r"^--preset, --plots beside --shift; allowed: --streams"):
        refuse({"--order": None, "--preset": True, "--seeds": False, "--plots": True}, "--streams")


def test_a_shift_alone_is_taken() -> None:
    refuse({"--order": None, "--seeds": False, "--visitors": ""}, "--streams")


def test_a_live_shift_starts_the_nodes_in_the_cell_for_shifts(tmp_path: Path) -> None:
    job = LiveShiftJob(tmp_path, 20, 1000, real_time_factor=0.25)
    overrides = job.overrides()
    assert {node for node, given in overrides.items() if given.get("preset") == '"shift"'} == {
        "sim", "vision", "layout", "fsm", "recorder",
    }  # fmt: skip
    assert (overrides["sim"]["seed"], overrides["sim"]["real_time_factor"]) == ("1000", "0.25")
