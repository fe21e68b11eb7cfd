"""Instances are told apart by what decides them; what there is not is refused at once."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from pack_bringup.cli.main import app
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.problem_file import load_problem
from pack_core.errors import ConfigError, PackError
from pack_core.paths import config_path
from pack_lockstep.blocks.benchmark_instances import FileInstance, ScatteredInstance, wanted_instances

EXAMPLE = config_path("scenarios", "blocks", "example.yaml")


def test_generated_instances_have_seeds_from_the_first_one_on() -> None:
    instances = wanted_instances(9, 0.2, range(3, 5), [])
    assert {instance.kind for instance in instances} == {"9 blocks, density 0.2"}
    assert [instance.name for instance in instances] == ["9_0.2_seed3", "9_0.2_seed4"]


def test_what_warms_up_is_an_instance_of_the_same_grid_that_is_not_measured() -> None:
    instance = ScatteredInstance(9, 0.2, 0)
    mine, other = (one.problem(blocks_cell()) for one in (instance, instance.warm_up))
    assert sorted(pose.row for pose in mine.goals.values()) == sorted(p.row for p in other.goals.values())
    assert mine.starts != other.starts


def test_files_take_the_place_of_generated_instances() -> None:
    (instance,) = wanted_instances(9, 0.2, range(20), [EXAMPLE])
    assert instance.kind == "example"
    assert instance.problem(blocks_cell()) == load_problem(EXAMPLE)


def test_a_file_that_was_changed_is_another_instance(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(EXAMPLE.read_text())
    before = FileInstance.read(path, 0)
    assert FileInstance.read(path, 0) == before
    path.write_text(EXAMPLE.read_text().replace("symmetry: 1", "symmetry: 4"))
    assert FileInstance.read(path, 0).name != before.name


def test_a_missing_or_broken_file_is_refused_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="scenarios/blocks/example"):
        FileInstance.read(tmp_path / "none.yaml", 0)
    path = tmp_path / "broken.yaml"
    path.write_text("blocks: []\n")
    with pytest.raises(ConfigError, match="workspace"):
        FileInstance.read(path, 0)


@pytest.mark.parametrize(
    ("option", "value", "part"),
    [("--method", "magic", "allowed: beam, pirs"), ("--problem", "none.yaml", "none.yaml: no such file")],
)
def test_the_command_refuses_what_there_is_not(option: str, value: str, part: str) -> None:
    with pytest.raises(PackError, match=part):
        CliRunner().invoke(app, ["benchmark", "blocks", option, value], catch_exceptions=False)
