"""What a reader of a report stumbles over: cut labels, blank or raw values, halves of files, memory."""

import gc
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from matplotlib.text import Text

from pack_evaluation.packing.evaluator import EVALUATOR
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.plots import draw_displacement, plot_of
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.studies import STUDIES
from pack_evaluation.packing.video import STAGE_TITLES
from pack_evaluation.record import about_the_run
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    writer = GoalWriter(folder)
    writer.write_goal(2.0, OUTCOME)
    writer.close()
    (folder / "run.yaml").write_text("cell: packing\npreset: ''\nversions: {mujoco: '3.3'}\n")
    return folder


@pytest.mark.parametrize("share", [0.1, 0.2])
def test_no_name_of_a_stage_is_cut_by_the_edge_or_hides_another(recording: Path, share: float) -> None:
    run = load_run(recording)
    count = run.iterations.times.size
    stages = ["PRE_PACK" if k < share * count else "INSERT" for k in range(count)]
    # This plot has a legend beside it, and so the least room for names.
    figure = plot_of(
        replace(run, iterations=replace(run.iterations, stages=tuple(stages))), draw_displacement
    )
    (axes,) = figure.axes
    titles = set(STAGE_TITLES.values())
    names = [text for text in axes.findobj(Text) if text.get_text() in titles]
    extents = [name.get_window_extent() for name in names]
    assert "INSERT" in {name.get_text() for name in names}
    edges = axes.get_window_extent()
    assert all(edges.x0 <= extent.x0 and extent.x1 <= edges.x1 for extent in extents)
    in_order = sorted(extents, key=lambda extent: extent.x0)
    assert all(left.x1 <= right.x0 for left, right in pairwise(in_order))


def test_the_record_of_a_run_is_told_in_words() -> None:
    versions = {"mujoco": "3.3", "numpy": "2.0"}
    record = {"preset": "", "seed": None, "versions": versions, "configuration": {"a": 1}}
    assert about_the_run(record) == {"preset": "none", "seed": "none", "versions": "mujoco 3.3, numpy 2.0"}


def test_a_report_has_neither_blank_rows_nor_the_look_of_python_and_explains_packed(recording: Path) -> None:
    found = EVALUATOR.evaluate(recording, recording, with_video=False)
    page = found.report.read_text()
    assert "<td>preset</td><td>none</td>" in page
    assert "<td>versions</td><td>mujoco 3.3</td>" in page
    assert "{&#39;" not in page
    (meaning,) = (row.meaning for row in found.rows if row.name == "packed")
    assert "INSERT" in meaning  # from where a run may end as packed, without a status of FINE-TUNE


def test_an_interrupted_rendering_leaves_no_half_of_a_video(recording: Path) -> None:
    def film(run: Run, path: Path, progress: object) -> None:
        path.write_bytes(b"half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        replace(EVALUATOR, film=film).evaluate(recording, recording)
    assert list(recording.glob("*.mp4")) == []


def test_many_recordings_are_measured_without_keeping_any_of_them(recording: Path) -> None:
    before = runs_in_memory()
    kept = [STUDIES.read_recording(recording) for _ in range(3)]
    assert kept
    assert runs_in_memory() <= before


def runs_in_memory() -> int:
    """How many runs are kept by whomever, fixtures of other tests included."""
    gc.collect()
    return sum(isinstance(item, Run) for item in gc.get_objects())
