"""From a recorded rearrangement to its measures, the plan step by step, video and report."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined

from pack_bringup.blocks.recorded_run import BlocksRun, load_blocks_run
from pack_bringup.blocks.run_measures import BlocksMeasures, measure, rows
from pack_bringup.blocks.run_video import Progress, write_video
from pack_core.cells.blocks import blocks_cell
from pack_core.evaluation.report import load_record
from pack_core.evaluation.table import Row
from pack_core.rearrangement.problem import Block
from pack_planner.rearrangement.drawing import write_plan

TEMPLATE = Path(__file__).with_name("report.html.j2")
VIDEO, REPORT, PLOTS = "run.mp4", "report.html", "plots"


@dataclass(frozen=True)
class BlocksEvaluation:
    """What an evaluation found and wrote; `video` is None where none was wanted."""

    run: BlocksRun
    measures: BlocksMeasures
    report: Path
    video: Path | None

    @property
    def rows(self) -> tuple[Row, ...]:
        """The measures in words."""
        return rows(self.measures)

    @property
    def is_cut(self) -> bool:
        """Whether the recording was cut off."""
        return self.run.is_cut

    def to_json(self) -> dict[str, Any]:
        """The measures as plain values."""
        return {**asdict(self.measures), "is_cut": self.run.is_cut}


def evaluate_blocks(
    path: Path, output: Path, *, with_video: bool = True, progress: Progress = lambda _: None
) -> BlocksEvaluation:
    """Measure a recording and write its report.

    Args:
        path: a run's folder, or its bag's.
        output: the folder for report.html, plots/ and run.mp4.
        with_video: render the run.
        progress: is told the fraction of the video done.

    Raises:
        BagError: the recording is missing, broken, or holds no rearrangement.
    """
    run = load_blocks_run(path)
    measures = measure(run)
    (output / PLOTS).mkdir(parents=True, exist_ok=True)
    video = output / VIDEO if with_video else None
    if video:
        write_video(run, blocks_cell(), video, progress)
    plots = _draw_plans(run, output / PLOTS)
    record = load_record(path) or load_record(path.parent)
    report = output / REPORT
    report.write_text(_report(run, measures, plots, video, record))
    return BlocksEvaluation(run, measures, report, video)


def _draw_plans(run: BlocksRun, folder: Path) -> list[Path]:
    """Every plan, from where its blocks stood when it was made."""
    drawn = []
    for number, plan in enumerate(run.plans, 1):
        first = {action.block: action.start for action in reversed(plan.actions)}
        blocks = tuple(Block(b.id, first.get(b.id, run.problem.goals[b.id])) for b in run.problem.blocks)
        problem = replace(run.problem, blocks=blocks)
        drawn.append(write_plan(problem, plan, folder / f"plan_{number}.png"))
    return drawn


def _report(
    run: BlocksRun,
    measures: BlocksMeasures,
    plots: list[Path],
    video: Path | None,
    record: Mapping[str, Any],
) -> str:
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    about = {key: _in_words(value) for key, value in record.items() if key != "configuration"}
    return environment.from_string(TEMPLATE.read_text()).render(
        title=f"{len(run.problem.blocks)} blocks", run=run, measures=measures, rows=rows(measures),
        plots=[_embedded(plot) for plot in plots], video=_embedded(video) if video else "", record=about,
    )  # fmt: skip


def _in_words(value: Any) -> str:
    return (
        ", ".join(f"{name} {part}" for name, part in value.items()) if isinstance(value, dict) else str(value)
    )


def _embedded(path: Path) -> str:
    return b64encode(path.read_bytes()).decode()
