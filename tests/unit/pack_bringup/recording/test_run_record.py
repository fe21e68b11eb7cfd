"""The folder of a run, and what is written there about it."""

from datetime import datetime

from pack_bringup.recording.run_record import default_folder

NOW = datetime(2026, 1, 1, 12)


def test_a_run_is_named_after_its_cell_date_preset_and_seed() -> None:
    assert default_folder("packing", 3, NOW).name == "packing_20260101_120000_seed3"
    assert default_folder("packing", None, NOW).name == "packing_20260101_120000"
    assert default_folder("packing", 3, NOW, "hardware").name == "packing_20260101_120000_hardware_seed3"


def test_a_preset_in_a_folder_of_its_own_makes_no_folder_of_runs() -> None:
    assert default_folder("packing", None, NOW, "mine/rough").name == "packing_20260101_120000_mine_rough"
