from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import pytest

from pack_bringup.packing.goals import preset_overrides
from pack_core.errors import ConfigError
from pack_core.packing.cell import packing_cell
from pack_core.paths import config_path
from pack_lockstep.packing.lockstep_config import PackingPreset, load_preset, lockstep_config
from pack_mpc.session import SessionConfig
from pack_sim.packing.simulator import SimulatorConfig

PRESETS = sorted(path.stem for path in config_path("presets", "packing").glob("*.yaml"))


@pytest.fixture
def presets(tmp_path: Path) -> Iterator[Path]:
    """A folder of presets in the place of config/presets."""

    def path(*parts: str) -> Path:
        return tmp_path.joinpath(*parts[2:]) if parts[0] == "presets" else config_path(*parts)

    with mock.patch("pack_core.presets.config_path", path):
        yield tmp_path


def test_the_ideal_preset_is_what_the_files_say() -> None:
    ideal = load_preset("ideal")
    assert ideal.packing_cell() == packing_cell()
    assert lockstep_config(ideal) == lockstep_config()


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_makes_a_cell_and_a_configuration(name: str) -> None:
    preset = load_preset(name)
    assert preset.packing_cell().scene.objects
    assert lockstep_config(preset).latency > 0


@pytest.mark.parametrize("name", PRESETS)
def test_the_driver_lets_the_arm_push_as_hard_as_the_planner_and_the_controller_mean_it_to(name: str) -> None:
    preset = load_preset(name)
    config = lockstep_config(preset)
    planned, pressed = preset.packing_cell().push.force, config.session.task.stages.press.force
    governor = config.simulator.governor
    assert max(planned, pressed) <= governor.push <= governor.force


def test_a_preset_changes_what_it_names_and_nothing_else() -> None:
    preset = PackingPreset(cell={"suction": {"shear": 12.0}}, sim={"mocap": {"latency": 0.05}})
    suction, before = preset.packing_cell().suction, packing_cell().suction
    assert (suction.shear, suction.pull, suction.moment) == (12.0, before.pull, before.moment)
    mocap = preset.parameters("sim", SimulatorConfig).mocap
    assert (mocap.latency, mocap.rate) == (0.05, lockstep_config().simulator.mocap.rate)


def test_a_preset_lies_over_its_base(presets: Path) -> None:
    (presets / "rough.yaml").write_text("sim: {mocap: {latency: 0.05, rate: 50.0}}\nmpc: {weights: table_1}")
    (presets / "rougher.yaml").write_text("base: rough\nsim: {mocap: {latency: 0.08}}")
    rougher = load_preset("rougher")
    mocap = rougher.parameters("sim", SimulatorConfig).mocap
    assert (mocap.latency, mocap.rate) == (0.08, 50.0)
    assert rougher.parameters("mpc", SessionConfig).weights == "table_1"


@pytest.mark.parametrize(
    ("upper", "lower", "error"),
    [
        ("sim: {mocap: {rate: -1.0}}", "sim: {mocap: {latency: 0.05}}", r"upper.* line 2: key 'mocap\.rate'"),
        ("sim: {mocap: {latency: 0.05}}", "sim: {mocap: {rate: -1.0}}", r"lower.* line 1: key 'mocap\.rate'"),
        ("sim: {mocap: {rate: -1.0}}", "sim: {mocap: {rate: -2.0}}", r"upper.* key 'mocap\.rate' is -1"),
        ("sim: {mocap: {speed: 1}}", "mpc: {weights: tuned}", r"upper.* line 2: key 'mocap\.speed' is not"),
        ("mpc: {weights: tuned}", "sim: {moccap: {}}", r"lower\.yaml, line 1: 'sim' has no moccap"),
        ("cell: {suction: {pull: -1}}", "cell: {suction: {shear: 9}}", r"upper.* key 'suction\.pull'"),
        ("mpc: {weights: tuned}", "cell: {suction: {pull: -1}}", r"lower.* line 1: key 'suction\.pull'"),
    ],
)  # fmt: skip
def test_an_error_names_the_preset_in_which_the_value_stands(
    upper: str, lower: str, error: str, presets: Path
) -> None:
    (presets / "upper.yaml").write_text(f"base: lower\n{upper}")
    (presets / "lower.yaml").write_text(lower)
    with pytest.raises(ConfigError, match=error):
        preset_overrides("upper")


def test_a_wrong_value_that_an_option_puts_over_a_preset_is_not_told_of_its_file(presets: Path) -> None:
    (presets / "rough.yaml").write_text("sim: {mocap: {rate: 50.0}}")
    preset = load_preset("rough").over("sim", {"mocap": {"rate": -1.0}})
    with pytest.raises(ConfigError, match=r"^options over the preset: key 'mocap\.rate'"):
        lockstep_config(preset)


def test_a_base_that_is_not_there_and_a_ring_are_refused(presets: Path) -> None:
    (presets / "lost.yaml").write_text("base: nothing")
    with pytest.raises(ConfigError, match="no preset 'nothing', the base of 'lost'; allowed: lost"):
        load_preset("lost")
    (presets / "one.yaml").write_text("base: two")
    (presets / "two.yaml").write_text("base: one")
    with pytest.raises(ConfigError, match="in a ring: one on two on one"):
        load_preset("one")


def test_values_over_a_preset_leave_the_preset_as_it_was() -> None:
    preset = PackingPreset(mpc={"weights": "tuned"})
    assert preset.over("mpc", {"weights": "table_1"}).parameters("mpc", SessionConfig).weights == "table_1"
    assert preset.parameters("mpc", SessionConfig).weights == "tuned"


@pytest.mark.parametrize(
    ("preset", "error"),
    [
        (PackingPreset(sim={"moccap": {}}), "'sim' has no moccap"),
        (PackingPreset(sim={"mocap": {"speed": 1}}), r"mocap\.speed' is not known"),
        (PackingPreset(sim={"mocap": {"rate": -1}}), r"mocap\.rate' is -1"),
    ],
)
def test_a_misspelt_or_impossible_value_is_refused(preset: PackingPreset, error: str) -> None:
    with pytest.raises(ConfigError, match=error):
        preset.parameters("sim", SimulatorConfig)


def test_the_steps_from_the_papers_system_lead_to_what_ships() -> None:
    shipped = lockstep_config(load_preset("ideal"))
    trigger = {"governor": {"trigger": shipped.simulator.governor.trigger}}
    ilqr = shipped.session.controller.ilqr.model_dump()  # which plans no more
    mpc = {"controller": {"ilqr": ilqr}, "load": shipped.session.load.model_dump()}
    last = load_preset("paper_press").over("sim", trigger).over("mpc", mpc)
    assert lockstep_config(last) == shipped


def test_an_unknown_preset_is_refused_with_those_that_exist() -> None:
    with pytest.raises(ConfigError, match=r"no preset 'perfect'; allowed: .*ideal"):
        load_preset("perfect")
