"""Many executions and plans of the blocks cell side by side: their measures summed up, and tables of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus, from_record
from pack_core.blocks.problem_file import parse_problem
from pack_evaluation.blocks.from_bag import load_blocks_run
from pack_evaluation.blocks.measures import BlocksMeasures, measure
from pack_evaluation.blocks.plan_drawing import write_plan
from pack_evaluation.blocks.reach_drawing import write_reach
from pack_evaluation.spread import PARTS, mean_p95_max, spread_text
from pack_evaluation.study import RECORDINGS, KeptTrials, ShownRun, Study, StudyEvaluator
from pack_evaluation.table import TextTable, column_a_study, measure_rows

Line = Mapping[str, Any]
OF_PLANS = {
    "first_plan_ms": "first plan [ms]",
    "first_actions": "actions of the first plan",
    "total_ms": "planning [ms]",
    "actions": "actions",
    "lower_bound": "no plan has fewer than",
    "pushes": "pushes among them",
    "pushed_m": "length of these pushes, summed [m]",
    "travel_m": "travel of the gripper [m]",
    "cleared": "blocks brought elsewhere than to their goals",
    "regrasps": "blocks put down and picked up again at once",
}
OF_EXECUTIONS = {
    "error_mm": "farthest block from its goal [mm]",
    "angle_deg": "most turned block [deg]",
    "disturbance_mm": "bystander moved [mm]",
    "slip_mm": "slip in the hand [mm]",
    "slip_deg": "turn in the hand [deg]",
    "duration_s": "simulated time [s]",
}
COUNTS = {
    "solved": ("solved", "instances"),
    "plans accepted by the verifier": ("verified", "solved"),
    "as short as the lower bound": ("at_lower_bound", "solved"),
    "carried out well": ("executed_ok", "executed"),
}
"""Rows of counts: name of the row, key of the count, key of the total."""


def summarize(lines: Sequence[Line]) -> dict[str, Any]:
    """Counts, and statistics of each measure; measures of plans are taken over the solved instances."""
    solved = [line for line in lines if line["is_solved"]]
    executions = [line["execution"] for line in lines if line["execution"] is not None]
    summary: dict[str, Any] = {
        "instances": len(lines),
        "statuses": dict(Counter(line["status"] for line in lines)),
        "solved": len(solved),
        "verified": sum(not line["faults"] for line in solved),
        "at_lower_bound": sum(line["actions"] == line["lower_bound"] for line in solved),
        **{key: mean_p95_max([line[key] for line in solved]) for key in OF_PLANS},
        "executed": len(executions),
        "executed_ok": sum(execution["is_ok"] for execution in executions),
        "executed_valid": sum(execution["is_valid"] for execution in executions),
    }
    return summary | {key: mean_p95_max([done[key] for done in executions]) for key in OF_EXECUTIONS}


def summarize_recordings(measured: Sequence[BlocksMeasures]) -> dict[str, Any]:
    """Counts, and statistics of the measures of each recording, errors being those of its worst block."""
    return {
        "recordings": len(measured),
        "arranged": sum(m.success for m in measured),
        "exit_reasons": dict(Counter(m.exit_reason for m in measured)),
        "error_mm": mean_p95_max([max(m.error_mm.values()) for m in measured]),
        "turn_deg": mean_p95_max([max(m.turn_deg.values()) for m in measured]),
        "actions": mean_p95_max([m.actions for m in measured]),
        "plans": mean_p95_max([m.plans for m in measured]),
        "duration_s": mean_p95_max([m.duration_s for m in measured]),
    }


def comparison(summaries: Mapping[str, Mapping[str, Any]], title: str) -> TextTable:
    """Table with a column for each study and a row for each measure that a study has."""
    found = summaries.values()
    rows = [
        *((name, lambda s, part=part, whole=whole: f"{s[part]} of {s[whole]}")
          for name, (part, whole) in COUNTS.items() if any(s[whole] for s in found)),
        *((name, lambda s, key=key: spread_text(s[key]))
          for key, name in (OF_PLANS | OF_EXECUTIONS).items()
          if any(s[key]["mean"] is not None for s in found)),
    ]  # fmt: skip
    note = f"Of every measure: {', '.join(PARTS.values())}; those of plans over the instances solved."
    return column_a_study(title, note, rows, summaries)


def instances(trials: Mapping[str, Sequence[Mapping[str, Any]]]) -> TextTable:
    """Table with a row for each instance and a column for each study.

    Args:
        trials: the trials of every study, by its name.
    """
    by_name = {(name, t["instance"]): t for name, found in trials.items() for t in found}
    known = dict.fromkeys(t["instance"] for found in trials.values() for t in found)
    lines = tuple((item, *(_outcome(by_name.get((name, item))) for name in trials)) for item in known)
    note = "Status, actions (lower bound), milliseconds to the first plan."
    return TextTable("Instances", note, ("instance", *trials), lines)


def recordings(measured: Sequence[tuple[str, BlocksMeasures]]) -> TextTable:
    """Table with a row for each measure and a column for each recording."""
    by_recording = [{row.name: row.value for row in measure_rows(measures)} for _, measures in measured]
    names = dict.fromkeys(name for values in by_recording for name in values)
    lines = tuple((name, *(values.get(name, "-") for values in by_recording)) for name in names)
    return TextTable("Recordings", "Every run with all nodes.", ("", *(name for name, _ in measured)), lines)


def _outcome(trial: Mapping[str, Any] | None) -> str:
    if trial is None:
        return ""
    if not trial["is_solved"]:
        return f"{trial['status']}: {trial['message']}"
    text = f"{trial['status']}, {trial['actions']} ({trial['lower_bound']}), {trial['first_plan_ms']:.1f} ms"
    return "; ".join([text, *trial["faults"]])


Recording = tuple[str, BlocksMeasures]
"""A recording's path and what was measured of it."""


@dataclass(frozen=True, kw_only=True)
class BlocksStudy(Study[Line]):
    """Instances that one method planned, or recordings; `detail` says which instances, and the budget.

    Attributes:
        recordings: runs with all nodes.
    """

    recordings: tuple[Recording, ...] = ()


def of_benchmark(kept: KeptTrials) -> list[BlocksStudy]:
    """One study a method, with the measures that every trial was kept with."""
    kept.require({"method", "kind", "problem", "execution", *OF_PLANS})
    methods = dict.fromkeys(trial["method"] for trial in kept.trials)
    return [
        BlocksStudy(name=method, detail=_detail(found, kept.settings), origin=kept.origin, trials=found)
        for method in methods
        for found in [tuple(trial for trial in kept.trials if trial["method"] == method)]
    ]


def summary(study: BlocksStudy) -> dict[str, Any]:
    """Counts and spreads, of trials or of recordings."""
    if study.recordings:
        return summarize_recordings([measures for _, measures in study.recordings])
    return summarize(study.trials)


def tables(studies: Sequence[BlocksStudy]) -> list[TextTable]:
    """Comparison of the methods, table of instances, table of recordings."""
    planned = [study for study in studies if not study.recordings]
    recorded = [item for study in studies for item in study.recordings]
    found: list[TextTable] = []
    if planned:
        title = f"Blocks: {'; '.join(dict.fromkeys(study.detail for study in planned))}"
        found.append(comparison({study.name: summary(study) for study in planned}, title))
        found.append(instances({study.name: study.trials for study in planned}))
    if recorded:
        found.append(recordings(recorded))
    return found


def drawn_plans(studies: Sequence[BlocksStudy], folder: Path, count: int, videos: int) -> list[ShownRun]:
    """The plans of each study's first `count` instances; there are no videos of planned instances."""
    drawn = []
    for i, study in enumerate(studies, 1):
        for trial in study.trials[:count]:
            made = Plan(
                PlanStatus[trial["status"]], from_record(trial["plan"]), trial["lower_bound"],
                Diagnosis(trial["message"]),
            )  # fmt: skip
            path = folder / "plans" / f"{i}_{trial['name']}.png"
            problem = parse_problem(trial["problem"], trial["name"])
            write_plan(problem, made, path)
            drawn.append(ShownRun(trial["name"], image=path))
            if made.actions:
                reach = folder / "plans" / f"{i}_{trial['name']}_reach.png"
                write_reach(problem, made, reach)
                drawn.append(ShownRun(f"{trial['name']}: within reach of one action", image=reach))
    return drawn


def _detail(trials: Sequence[Line], settings: Mapping[str, Any]) -> str:
    """Which instances, and how long a plan may take."""
    kinds = ", ".join(dict.fromkeys(trial["kind"] for trial in trials))
    return f"{kinds}, {settings['budget']:g} s a plan"


STUDIES = StudyEvaluator(
    title="Blocks", of_benchmark=of_benchmark,
    read_recording=lambda path: (str(path), measure(load_blocks_run(path))),
    of_recordings=lambda found: BlocksStudy(name=RECORDINGS, recordings=tuple(found)), summary=summary,
    tables=tables, shown_runs=drawn_plans, runs_title="Plans, step by step",
    runs_note="Blue: picked and placed; orange: pushed; green: at its goal; grey: waiting; outlined: goals.",
)  # fmt: skip
