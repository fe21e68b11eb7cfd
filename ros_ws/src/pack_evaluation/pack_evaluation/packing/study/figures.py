"""A study's figures: box plots of the failure metrics (Fig. 5), and share of packed scenes over time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pack_evaluation.packing.study.summary import FAILURE_METRICS
from pack_evaluation.packing.study.tables import METRIC_NAMES
from pack_evaluation.packing.study.trial import PackingStudy, PackingTrial

FIG_5 = ("m_pos_mm", "m_rot_deg", "m_per")
MAROON = "#800000"
DPI = 130


def write_figures(studies: Sequence[PackingStudy], folder: Path) -> list[Path]:
    """Write every figure as PNG into `folder`, in the order a report shows them."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [_write_packed_by(studies, folder / "packed_by.png")]
    for i, study in enumerate(studies):
        paths.append(_write_boxes(study, folder / f"failure_metrics_{i + 1}.png"))
    return paths


def _write_boxes(study: PackingStudy, path: Path) -> Path:
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    figure.suptitle(study.name)
    for axes, name in zip(figure.subplots(1, len(FIG_5)), FIG_5, strict=True):
        _draw_boxes(axes, name, study)
    figure.savefig(path, dpi=DPI)
    return path


def _draw_boxes(axes: Axes, name: str, study: PackingStudy) -> None:
    """One metric as in Fig. 5: quartiles, whiskers to 1.5 of their range, median maroon, mean a triangle."""
    groups = {
        f"success ({len(study.successes)})": _values(name, study.successes),
        f"failure ({len(study.failures)})": _values(name, study.failures),
    }
    axes.boxplot(
        list(groups.values()), tick_labels=list(groups), whis=1.5, showmeans=True, widths=0.5,
        medianprops={"color": MAROON, "linewidth": 1.6},
        meanprops={"marker": "^", "markerfacecolor": "blue", "markeredgecolor": "blue"},
    )  # fmt: skip
    axes.set_title(METRIC_NAMES[name], fontsize=10)
    axes.set_ylim(bottom=0.0)
    axes.grid(axis="y", alpha=0.25)


def _values(name: str, trials: Sequence[PackingTrial]) -> list[float]:
    values = [FAILURE_METRICS[name](trial.measures) for trial in trials]
    return [value for value in values if not np.isnan(value)]


def _write_packed_by(studies: Sequence[PackingStudy], path: Path) -> Path:
    """Share of the scenes that are packed and done, by simulated time."""
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    axes = figure.add_subplot()
    end = max((t.measures.execution_time for s in studies for t in s.trials), default=1.0)
    for study in studies:
        times = np.sort([trial.measures.execution_time for trial in study.successes])
        share = 100.0 * np.arange(times.size + 1) / max(1, len(study.trials))
        axes.step([0.0, *times, end], [*share, share[-1]], where="post", label=study.name)
    axes.set(xlabel="time since the goal [s]", ylabel="scenes packed [%]", ylim=(0, 102), xlim=(0, end))
    axes.grid(alpha=0.25)
    axes.legend(loc="lower right", frameon=False)
    figure.savefig(path, dpi=DPI)
    return path
