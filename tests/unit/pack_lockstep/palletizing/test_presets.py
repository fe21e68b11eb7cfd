"""Presets of the palletizing cell: what each one changes."""

from pathlib import Path

import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.paths import config_path
from pack_lockstep.palletizing.settings import set_up

PRESETS = sorted(path.stem for path in config_path("presets", "palletizing").glob("*.yaml"))


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_makes_a_cell_and_a_configuration(name: str) -> None:
    setup = set_up(preset=name)
    assert setup.cell.preset == name
    assert name in setup.name


def test_the_rigid_preset_is_what_the_files_say() -> None:
    setup = set_up()
    assert (setup.config.palletizer.profile, setup.config.motion) == ("blended", "shipped")
    assert setup.cell.imperfections.gears is None
    assert setup.config.simulator.has_limits


def test_the_thesis_has_its_profile_its_policies_and_no_limits() -> None:
    setup = set_up(preset="thesis")
    assert (setup.config.palletizer.profile, setup.config.motion) == ("thesis", "table_4_1")
    assert not setup.config.simulator.has_limits
    assert setup.cell.model_copy(update={"preset": "rigid"}) == palletizing_cell()


def test_options_go_over_the_preset() -> None:
    setup = set_up(preset="thesis", profile="blended", motion="shipped", has_limits=True, gap_mm=3.0)
    assert (setup.config.palletizer.profile, setup.config.motion) == ("blended", "shipped")
    assert setup.config.simulator.has_limits
    assert setup.layout.separator.gap == pytest.approx(0.003)


def test_a_parameter_that_no_core_knows_is_refused(tmp_path, monkeypatch) -> None:
    (tmp_path / "presets" / "palletizing").mkdir(parents=True)
    (tmp_path / "presets" / "palletizing" / "odd.yaml").write_text("fsm: {colour: red}")
    monkeypatch.setattr("pack_core.presets.config_path", lambda *parts: tmp_path.joinpath(*parts))
    with pytest.raises(ConfigError, match=r"odd\.yaml, line 1: 'fsm' has no colour; allowed: profile"):
        set_up(preset="odd")


@pytest.mark.parametrize(
    ("upper", "lower", "error"),
    [
        ("{}", "layout: {separator: {gap: -1.0}}", r"lower\.yaml, line 1: key 'separator\.gap' is -1\.0"),
        ("cell: {scanners: {period: -1}}", "{}", r"upper\.yaml, line 2: key 'scanners\.period' is not known"),
        ("cell: {pallet: {size: [0.1, -1]}}", "cell: {pallet: {size: [0.1, 0.2]}}", r"upper\.yaml, line 2: "),
    ],
)
def test_an_error_names_the_preset_in_which_the_value_stands(
    upper: str, lower: str, error: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "presets" / "palletizing"
    folder.mkdir(parents=True)
    (folder / "upper.yaml").write_text(f"base: lower\n{upper if upper != '{}' else ''}")
    (folder / "lower.yaml").write_text(lower)
    monkeypatch.setattr("pack_core.presets.config_path", lambda *parts: tmp_path.joinpath(*parts))
    with pytest.raises(ConfigError, match=error):
        set_up(preset="upper")
