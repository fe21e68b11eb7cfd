"""Presets of the palletizing cell: what each one changes."""

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
    with pytest.raises(ConfigError, match="preset 'odd': 'fsm' has no colour; allowed: profile"):
        set_up(preset="odd")
