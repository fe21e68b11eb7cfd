"""`pack benchmark palletizing --shift` and orders take no option that would have no effect."""

from dataclasses import fields
from pathlib import Path

import pytest

from pack_bringup.palletizing.goals import LiveShiftJob
from pack_bringup.palletizing.shift_command import ShiftOptions, refuse, require_shift
from pack_core.errors import ConfigError


def test_options_for_orders_are_named() -> None:
    with pytest.raises(ConfigError, match=r"^--preset, --plots beside --shift; allowed: --streams"):
        refuse({"--order": None, "--preset": True, "--seeds": False, "--plots": True}, "--streams")


def test_options_for_shifts_are_named_where_there_is_none() -> None:
    given = ShiftOptions(streams=3, open_pallets=1)
    with pytest.raises(ConfigError, match=r"^--streams, --open-pallets without --shift"):
        require_shift(given.given())


def test_options_that_are_left_out_are_taken_with_and_without_a_shift() -> None:
    refuse({"--order": None, "--seeds": False, "--visitors": ""}, "--streams")
    require_shift(ShiftOptions().given())
    assert len(ShiftOptions().given()) == len(fields(ShiftOptions))


def test_a_live_shift_starts_the_nodes_in_the_cell_for_shifts(tmp_path: Path) -> None:
    job = LiveShiftJob(tmp_path, 20, 1000, real_time_factor=0.25)
    overrides = job.overrides()
    assert {node for node, given in overrides.items() if given.get("preset") == '"shift"'} == {
        "sim", "vision", "layout", "fsm", "recorder",
    }  # fmt: skip
    assert (overrides["sim"]["seed"], overrides["sim"]["real_time_factor"]) == ("1000", "0.25")
