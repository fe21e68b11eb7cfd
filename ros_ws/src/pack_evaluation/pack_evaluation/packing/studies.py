"""Many packing runs side by side, in the tables and figures of the paper."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from pack_core.packing.goals import PackingExitReason
from pack_evaluation.figures import write_figures
from pack_evaluation.packing.fill.recording import has_fill_job
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import CYCLE_MS
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.run_file import SUFFIX, load_saved_run
from pack_evaluation.packing.summary import (
    FAILURE_METRICS,
    PackingStudy,
    PackingTrial,
    failure_metrics,
    summarize,
    trial_of,
)
from pack_evaluation.packing.video import add_caption, write_video
from pack_evaluation.packing.view import View, ViewConfig
from pack_evaluation.spread import Spread
from pack_evaluation.study import RECORDINGS, KeptTrials, ShownRun, StudyEvaluator
from pack_evaluation.table import TextTable, optional_number, row_a_study

RUNS = "runs"
"""Folder, below a benchmark's, with the run of each trial."""
ABOUT = ("method", "optimizer", "weights", "preset", "container", "scene_dir")
"""Settings that the summary and the report show."""
SIZE = {"width": 640, "height": 360}
"""Of the pictures of failures [pixel]."""
FIG_5 = ("m_pos_mm", "m_rot_deg", "m_per")
MAROON = "#800000"
FIXED = (PackingExitReason.FORCE, PackingExitReason.DETACHED, PackingExitReason.TIMEOUT)
"""Exit reasons that have a column even if no trial ended so."""
METRIC_NAMES = {
    "m_pos_mm": "M_pos [mm] (Eq. 7)",
    "m_rot_deg": "M_rot [deg] (Eq. 8)",
    "m_per": "M_per [objects] (Eq. 9)",
    "grip_error_mm": "grip error [mm]",
    "perception_error_mm": "perception error [mm]",
    "perception_error_deg": "perception error, held [deg]",
    "placements": "placements tried",
    "peak_force_N": "peak force [N]",
}
Summary = Mapping[str, Any]


def of_benchmark(kept: KeptTrials) -> list[PackingStudy]:
    """One study: the trials of a method under one setting, measured from their runs."""

    def load(name: str) -> Run:
        return load_saved_run(kept.folder / RUNS / f"{name}{SUFFIX}")

    names = [str(trial["name"]) for trial in kept.trials]
    about = {key: kept.settings[key] for key in ABOUT if kept.settings.get(key) is not None}
    trials = tuple(trial_of(name, load(name)) for name in names)
    return [
        PackingStudy(name=kept.settings["name"], about=about, origin=kept.origin, trials=trials, load=load)
    ]


def of_recordings(recordings: Sequence[PackingTrial]) -> PackingStudy:
    """All recordings as trials, each named by its path."""
    return PackingStudy(name=RECORDINGS, trials=tuple(recordings), load=lambda name: load_run(Path(name)))


def tables(studies: Sequence[PackingStudy]) -> tuple[TextTable, ...]:
    """The paper's Tables II and III, contact forces, iterations, and failure metrics of each study."""
    found = {study.name: summarize(study) for study in studies}
    return (results(found), ends(found), forces(found), iterations(found), *map(metrics, studies))


def results(summaries: Mapping[str, Summary]) -> TextTable:
    """Tables II and III: success, exits, execution time, distance, force."""
    found = {reason.value for reason in FIXED}.union(*(s["exits"] for s in summaries.values()))
    kinds = [r.value for r in PackingExitReason if r.value in found and r is not PackingExitReason.PLACED]
    note = (
        "Success is reaching FINE-TUNE; a run that did so and was not placed in time counts under both. "
        "Mean ± standard deviation over trials; the time leaves out what a force stop or a detachment ended."
    )
    columns = [
        ("success", lambda s: f"{s['success']}/{s['scenes']}"),
        *((kind.replace("_", " "), lambda s, kind=kind: str(s["exits"].get(kind, 0))) for kind in kinds),
        ("time [s]", lambda s: _plus_minus(s["execution_time_s"])),
        ("distance [cm]", lambda s: _plus_minus(s["distance_cm"])),
        (
            "force [N]",
            lambda s: _pm(*(s["contact_force_N"][f"{of}_of_trials"] for of in ("mean", "deviation"))),
        ),
    ]
    return row_a_study("Packing", note, columns, summaries)


def ends(summaries: Mapping[str, Summary]) -> TextTable:
    """Where the objects end: the paper's condition of section II beside its count of successes."""
    note = (
        "Contained: at the end the object is between the walls, to 3 mm, and its centre below their rim. "
        "Protrusion is how far it truly reaches beyond their inner faces, at any height."
    )
    columns = [
        ("contained", lambda s: f"{s['containment']['contained']}/{s['scenes']}"),
        ("of the packed", lambda s: f"{s['containment']['packed_and_contained']}/{s['success']}"),
        ("protrusion [mm]", lambda s: _plus_minus(s["containment"]["protrusion_mm"])),
        ("95 %", lambda s: optional_number(s["containment"]["protrusion_mm"]["p95"])),
        ("largest", lambda s: optional_number(s["containment"]["max_protrusion_mm"])),
        ("tilt [deg]", lambda s: _plus_minus(s["containment"]["tilt_deg"])),
        ("95 %", lambda s: optional_number(s["containment"]["tilt_deg"]["p95"])),
    ]
    return row_a_study("Containment", note, columns, summaries)


def forces(summaries: Mapping[str, Summary]) -> TextTable:
    """Contact force over all samples, its peaks, and how often it jumps."""
    note = (
        "Load on the cup less the object's weight, all samples of a study; peaks behind a 5 ms low-pass. "
        "Chatter: share of samples in contact that differ by over 5 N from the one 8 ms before, mean over "
        "trials."
    )
    parts = {
        "mean [N]": "mean", "deviation": "deviation", "median": "median", "95 %": "p95",
        "mean peak": "mean_peak", "highest peak": "max_peak",
    }  # fmt: skip
    columns = [
        *((head, lambda s, part=part: optional_number(s["contact_force_N"][part]))
          for head, part in parts.items()),
        ("chatter [%]", lambda s: optional_number(s["chatter_percent"]["mean"], 1)),
    ]  # fmt: skip
    return row_a_study("Contact force", note, columns, summaries)


def iterations(summaries: Mapping[str, Summary]) -> TextTable:
    """Wall clock of the controller, and how many placements it took."""
    parts = {"mean [ms]": "mean", "deviation": "deviation", "median": "median", "95 %": "p95"}
    late = {f"over {limit:.0f} ms [%]": f"over_{limit:.0f}_ms" for limit in (CYCLE_MS, 2 * CYCLE_MS)}
    columns = [
        *((head, lambda s, part=part: optional_number(s["iteration_ms"][part], 1))
          for head, part in parts.items()),
        *((head, lambda s, key=key: optional_number(s["late_iterations_percent"][key], 1))
          for head, key in late.items()),
        ("placements", lambda s: optional_number(s["placements"]["mean"])),
        ("packed at the first", lambda s: f"{s['first_attempt']}/{s['scenes']}"),
    ]  # fmt: skip
    note = "Wall clock of a controller iteration on the machine that ran it, and placements tried a trial."
    return row_a_study("Controller", note, columns, summaries)


def metrics(study: PackingStudy) -> TextTable:
    """The failure metrics of section IV-E, of successes against failures."""
    rows = tuple(
        (METRIC_NAMES[name], _pair(item.success), _pair(item.failure), optional_number(item.auc))
        for name, item in failure_metrics(study).items()
    )
    n, m = len(study.successes), len(study.failures)
    note = f"{n} successes, {m} failures. AUC: probability that a failure measures more; 0.5 tells nothing."
    return TextTable(f"Failure metrics: {study.name}", note, ("", "success", "failure", "AUC"), rows)


def _pair(item: Spread) -> str:
    return _pm(item.mean, item.deviation)


def _plus_minus(item: Mapping[str, float | None]) -> str:
    return _pm(item["mean"], item["deviation"])


def _pm(mean: float | None, deviation: float | None) -> str:
    return "-" if mean is None or deviation is None else f"{mean:.2f} ± {deviation:.2f}"


def failures(studies: Sequence[PackingStudy], folder: Path, count: int, videos: int) -> list[ShownRun]:
    """Every failed run of each study: the last moment of the first `count`, and `videos` of them whole."""
    shown = []
    for number, study in enumerate(studies, 1):
        for i, trial in enumerate(study.failures):
            m = trial.measures
            run = ShownRun(trial.name, f"{m.exit_reason.value}, {trial.message}; {m.placements} placements")
            if i < count and study.load is not None:
                below = folder / "failures" / str(number)
                run = _drawn(run, study.load(trial.name), below, with_video=i < videos)
            shown.append(run)
    return shown


def _drawn(shown: ShownRun, run: Run, folder: Path, *, with_video: bool) -> ShownRun:
    folder.mkdir(parents=True, exist_ok=True)
    stem = shown.name.strip("/").replace("/", "_")  # a recording is named by its path
    image, video = folder / f"{stem}.png", folder / f"{stem}.mp4" if with_video else None
    with View(run, ViewConfig().model_copy(update=SIZE)) as view:
        Image.fromarray(add_caption(view.picture(run.end), run, run.end)).save(image)
    if video:
        write_video(run, video)
    return replace(shown, image=image, video=video)


def figures(studies: Sequence[PackingStudy], folder: Path) -> list[Path]:
    """Share of packed scenes over time, and the box plots of Fig. 5, of each study."""
    boxes = {f"failure_metrics_{i}": draw_failure_metrics(study) for i, study in enumerate(studies, 1)}
    return write_figures({"packed_by": draw_packed_by(studies), **boxes}, folder)


def draw_failure_metrics(study: PackingStudy) -> Figure:
    """Fig. 5: three metrics of successes and of failures."""
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    figure.suptitle(study.name)
    for axes, name in zip(figure.subplots(1, len(FIG_5)), FIG_5, strict=True):
        _draw_boxes(axes, name, study)
    return figure


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


def draw_packed_by(studies: Sequence[PackingStudy]) -> Figure:
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
    return figure


STUDIES = StudyEvaluator(
    title="Packing", of_benchmark=of_benchmark,
    read_recording=lambda path: trial_of(str(path), load_run(path)), of_recordings=of_recordings,
    summary=summarize, tables=tables, figures=figures, shown_runs=failures, runs_title="Failures",
    runs_note="The last moment of each failed run; the translucent shape is the packing pose.",
    kind_of=lambda path: "fill_studies" if has_fill_job(path) else "studies",
)  # fmt: skip
"""Measures every trial from its run, whether lockstep or a recording kept it."""
