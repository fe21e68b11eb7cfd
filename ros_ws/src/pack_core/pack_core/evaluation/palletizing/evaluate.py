"""From a recorded order to its measures, plots, video and report."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined

from pack_core.evaluation.palletizing.from_bag import load_pallet_run
from pack_core.evaluation.palletizing.measures import OrderMeasures, measure_order
from pack_core.evaluation.palletizing.pallet_run import PalletRun
from pack_core.evaluation.palletizing.plots import write_plots
from pack_core.evaluation.palletizing.table import order_rows
from pack_core.evaluation.palletizing.video import Progress, write_video
from pack_core.evaluation.report import load_record
from pack_core.evaluation.table import Row

TEMPLATE = Path(__file__).with_name("report.html.j2")
VIDEO, REPORT, PLOTS = "run.mp4", "report.html", "plots"


@dataclass(frozen=True)
class PalletEvaluation:
    """What an evaluation found and wrote; `video` is None where none was wanted."""

    run: PalletRun
    measures: OrderMeasures
    report: Path
    video: Path | None

    @property
    def rows(self) -> tuple[Row, ...]:
        """The measures in words."""
        return order_rows(self.measures)

    @property
    def is_cut(self) -> bool:
        """Whether the recording was cut off."""
        return self.run.is_cut

    def to_json(self) -> dict[str, Any]:
        """The measures as plain values."""
        return {**asdict(self.measures), "is_cut": self.run.is_cut}


def evaluate_order(
    path: Path, output: Path, *, with_video: bool = True, progress: Progress = lambda _: None
) -> PalletEvaluation:
    """Measure a recording and write its report.

    Args:
        path: a run's folder, a bag's folder or an MCAP file.
        output: the folder for report.html, plots/ and run.mp4.
        with_video: render the run.
        progress: is told the fraction of the video done.

    Raises:
        BagError: the recording is missing, broken, or holds no order.
        PackError: the video was wanted and there is no OpenGL to draw with.
    """
    run = load_pallet_run(path)
    measures = measure_order(run)
    output.mkdir(parents=True, exist_ok=True)
    video = output / VIDEO if with_video else None
    if video:
        write_video(run, video, progress)
    record = load_record(path) or load_record(path.parent)
    report = output / REPORT
    report.write_text(_report(run, measures, write_plots(run, output / PLOTS), video, record))
    return PalletEvaluation(run, measures, report, video)


def _report(
    run: PalletRun, measures: OrderMeasures, plots: list[Path], video: Path | None, record: Mapping[str, Any]
) -> str:
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    about = {key: value for key, value in record.items() if key != "configuration"}
    return environment.from_string(TEMPLATE.read_text()).render(
        title=f"Order {run.order}", run=run, measures=measures, rows=order_rows(measures),
        number=lambda value: "-" if value is None else f"{value:.2f}", record=about,
        plots=[(plot.stem, _embedded(plot)) for plot in plots], video=_embedded(video) if video else "",
    )  # fmt: skip


def _embedded(path: Path) -> str:
    return b64encode(path.read_bytes()).decode()
