"""A fill job as its user runs it: filled, recorded, evaluated again, and replayed."""

from pathlib import Path

import pytest

from e2e.command import alarms, measured_again, output_of, pack
from pack_evaluation.packing.fill.evaluator import measure
from pack_evaluation.packing.fill.recording import load_fill_run

# two minutes: two objects at 0.3 of real time
pytestmark = [pytest.mark.e2e, pytest.mark.long, pytest.mark.timeout(600)]
LIST = """
objects:
  - {name: can, shape: cylinder, radius: 0.034, height: 0.08, mass: 0.3}
  - {name: carton, shape: box, size: [0.09, 0.06, 0.1], mass: 0.3}
"""


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Two objects filled into the container: the run's folder, and what was printed."""
    folder = tmp_path_factory.mktemp("demo")
    (folder / "list.yaml").write_text(LIST)
    slowly = ("--real-time-factor", "0.3")
    process = pack(
        "demo", "packing", "--fill", folder / "list.yaml", "--seed", "3", *slowly, "--output", folder / "run"
    )
    text = output_of(process)
    assert process.returncode == 0, text
    return folder / "run", text


def test_the_demo_fills_the_container_and_leaves_everything_behind(demo: tuple[Path, str]) -> None:
    folder, _ = demo
    assert {"bag", "nodes.log", "report.html", "run.mp4", "run.yaml"} <= {
        path.name for path in folder.iterdir()
    }
    found = measure(load_fill_run(folder))
    assert (found.success, found.packed, found.given, found.faults) == (True, 2, 2, 0)


def test_a_healthy_start_run_and_end_log_no_error(demo: tuple[Path, str]) -> None:
    assert alarms(demo[0]) == []


def test_evaluating_the_bag_again_gives_the_same_measures(demo: tuple[Path, str], tmp_path: Path) -> None:
    again = measured_again(demo[0], tmp_path)
    first = measure(load_fill_run(demo[0]))
    assert (again["packed"], again["base_area"]) == (first.packed, pytest.approx(first.base_area))


def test_perception_replayed_on_the_recording_estimates_what_it_did(demo: tuple[Path, str]) -> None:
    process = pack("replay", demo[0])
    text = output_of(process)
    assert process.returncode == 0, text
    assert "can" in text
    assert "carton" in text


def test_the_planner_is_not_replayed_on_a_fill_job_and_the_reason_is_said(demo: tuple[Path, str]) -> None:
    process = pack("replay", demo[0], "--node", "planner")
    text = " ".join(output_of(process).split())
    assert process.returncode == 2, text
    assert "fill job" in text
    assert "--node perception" in text
