import json
import pickle
import sys
from pathlib import Path

import pytest

from pack_core.config import validate_config
from pack_core.errors import ConfigError, PackError
from pack_core.packing.goals import PackingMethod
from pack_core.paths import project_root
from pack_lockstep.benchmarking.results_folder import plain
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.packing.settings import BenchmarkSettings, parse_size, scene_jobs, set_up
from pack_mpc.optimizers import OPTIMIZERS
from pack_mpc.session import SessionConfig

EASY = project_root() / "tests" / "e2e" / "packing" / "easy_scene.yaml"


def test_settings_reach_the_cores() -> None:
    settings = BenchmarkSettings(optimizer="sgn", weights="table_1", container=(0.24, 0.19))
    setup = set_up(settings, threads=3)
    session = setup.config.session
    assert (session.controller.optimizer, session.weights) == ("sgn", "table_1")
    assert session.controller.threads == setup.config.planner.threads == 3
    assert setup.cell.scene.container.size == (0.24, 0.19)
    assert setup.name == "pack_it_in sgn table_1 ideal 240x190mm"
    assert pickle.loads(pickle.dumps(setup)) == setup


def test_what_is_not_set_is_as_the_controllers_node_has_it() -> None:
    given = set_up(BenchmarkSettings(), 1)
    node = load_parameters("packing/mpc", SessionConfig)
    assert (given.optimizer, given.config.session.weights) == (node.controller.optimizer, node.weights)
    explicit = set_up(BenchmarkSettings(optimizer=given.optimizer, weights=node.weights), 1).record()
    assert {**given.record(), "optimizer": given.optimizer} == explicit


def test_threads_decide_no_result_and_are_not_among_the_settings() -> None:
    assert set_up(BenchmarkSettings(), 1).record() == set_up(BenchmarkSettings(), 4).record()


@pytest.mark.parametrize(
    "change",
    [
        {"method": PackingMethod.UNINFORMED_POSE},
        {"optimizer": "sgn"},
        {"container": (0.24, 0.19)},
        {"blocked": False},
    ],
)
def test_what_decides_a_result_is_among_the_settings(change: dict[str, object]) -> None:
    settings = BenchmarkSettings(optimizer="ilqr")
    changed = settings.model_copy(update=change)
    assert set_up(changed, 1).record() != set_up(settings, 1).record()


def test_the_record_is_json() -> None:
    assert json.loads(json.dumps(plain(set_up(BenchmarkSettings(), 1).record()), allow_nan=False))


def test_unknown_weights_are_refused() -> None:
    with pytest.raises(ConfigError, match="no weight set 'heavy'"):
        set_up(BenchmarkSettings(weights="heavy"), 1).record()


def test_an_optimizer_that_is_not_installed_is_an_error_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "judo.optimizers.cem", None)
    with pytest.raises(PackError, match=r"requirements/judo\.txt"):
        set_up(BenchmarkSettings(optimizer="judo"), 1)


def test_an_unknown_optimizer_is_refused_with_those_that_exist() -> None:
    with pytest.raises(ConfigError, match=f"'optimizer' is 'magic'; allowed: {', '.join(OPTIMIZERS)}"):
        validate_config(BenchmarkSettings, {"optimizer": "magic"}, "pack benchmark packing")


def test_parameters_of_the_optimizer_that_plans_are_among_the_settings_and_no_others() -> None:
    controller = set_up(BenchmarkSettings(optimizer="ilqr"), 1).record()["config"]["session"]["controller"]
    assert OPTIMIZERS.keys() & controller.keys() == {"ilqr"}


def test_scenes_have_rising_seeds() -> None:
    jobs = scene_jobs(BenchmarkSettings(), 1000, 3)
    assert [(job.name, job.seed, job.scene) for job in jobs] == [
        ("seed_1000", 1000, None),
        ("seed_1001", 1001, None),
        ("seed_1002", 1002, None),
    ]


def test_a_folder_of_scenes_is_taken_in_order_of_names(tmp_path: Path) -> None:
    for name in ("b", "a", "c"):
        (tmp_path / f"{name}.yaml").write_text(EASY.read_text())
    jobs = scene_jobs(BenchmarkSettings(scene_dir=tmp_path), 5, 2)
    assert [(job.name, job.seed) for job in jobs] == [("a_seed5", 5), ("b_seed6", 6)]
    assert jobs[0].scene is not None
    assert jobs[0].scene.names == ["soup_can", "tea_box"]


def test_too_few_scene_files_are_refused_with_the_number_that_there_is(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(EASY.read_text())
    with pytest.raises(ConfigError, match=r"has 1 scene files .* give --scenes 1"):
        scene_jobs(BenchmarkSettings(scene_dir=tmp_path), 0, 2)


def test_a_container_is_two_lengths() -> None:
    assert parse_size("0.24x0.19") == (0.24, 0.19)
    for text in ("0.24", "24x", "0.24 x 0.19", "axb"):
        with pytest.raises(ConfigError, match=r"0\.24x0\.19"):
            parse_size(text)
