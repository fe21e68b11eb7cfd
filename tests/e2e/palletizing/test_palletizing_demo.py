import json
from pathlib import Path

import pytest

from e2e.command import alarms, output_of, pack
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_evaluation.palletizing.from_bag import load_pallet_run
from pack_evaluation.palletizing.measures import measure_order

# A run takes a minute of processor time: what demos have in common is tested with that of packing, the rest
# in tests/integration/palletizing.
pytestmark = [pytest.mark.e2e, pytest.mark.timeout(900)]
FACTOR = 0.4
"""Simulated seconds a second: what a busy machine with two cores keeps up with."""


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """One box, turned in flight, on a pallet: the run's folder, and what was printed."""
    folder = tmp_path_factory.mktemp("demo") / "run"
    order = folder.with_name("order.json")
    given = load_order(config_path("orders", "order_03.json"))
    small = {
        "order_id": "one box",
        "pallet": given.pallet.model_dump(),
        "boxes": [given.boxes[0].model_dump()],
    }
    order.write_text(json.dumps(small))
    process = pack(
        "demo", "palletizing", "--order", order, "--real-time-factor", str(FACTOR), "--output", folder
    )
    text = output_of(process)
    assert process.returncode == 0, text
    return folder, text


@pytest.mark.long
def test_the_demo_builds_the_pallet_and_leaves_everything_behind(demo: tuple[Path, str]) -> None:
    folder, _ = demo
    assert {path.name for path in folder.iterdir()} == {
        "bag", "nodes.log", "plots", "replay.html", "report.html", "run.mp4", "run.yaml",
    }  # fmt: skip
    run = load_pallet_run(folder)
    assert [box.outcome for box in run.boxes] == ["placed"]


@pytest.mark.long
def test_a_healthy_start_run_and_end_log_no_error(demo: tuple[Path, str]) -> None:
    assert alarms(demo[0]) == []


@pytest.mark.long
def test_the_measures_of_the_recording_are_within_their_targets(demo: tuple[Path, str]) -> None:
    measures = measure_order(load_pallet_run(demo[0]))
    assert measures.is_complete
    assert (measures.drops, measures.touches) == (0, 0)
    (box,) = measures.boxes
    assert box.weight_error_kg == pytest.approx(0.0, abs=0.5)


def test_an_order_that_would_not_stand_is_refused_at_once(tmp_path: Path) -> None:
    unstable = config_path("orders", "stress", "order_01.json")
    process = pack("demo", "palletizing", "--order", unstable, "--output", tmp_path / "run")
    text = output_of(process)
    assert process.returncode == 2
    assert "error:" in text
