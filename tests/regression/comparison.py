"""What differs between two recorded runs of the same command, but for what the wall clock decides."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

OF_THE_MACHINE = {
    "iteration_ms", "iterations/ms", "late_iterations_percent", "threads", "wall_time_s", "real_time_factor",
    "real_time_factors", "first_plan_ms", "total_ms", "planning_ms", "origin", "command",
}  # fmt: skip
"""Keys of values that depend on the machine, its load or the call, and not on the cell."""
ABSENT = "(absent)"


class RunMissingError(Exception):
    """A folder lacks a file of results without which a run cannot be compared."""


def differences(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Every place at which two JSON values differ, with both values."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(key for key in new if key not in old)]:
            if key not in OF_THE_MACHINE:
                yield from differences(old.get(key, ABSENT), new.get(key, ABSENT), f"{place}/{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for k, (one, other) in enumerate(zip(old, new, strict=True)):
            yield from differences(one, other, f"{place}[{k}]")
    elif old != new:
        yield f"{place}: {old} -> {new}"


def array_differences(old: Path, new: Path) -> Iterator[str]:
    """The arrays of two `.npz` files that are not equal to the last bit."""
    with np.load(old) as before, np.load(new) as after:
        for name in sorted({*before.files, *after.files} - OF_THE_MACHINE):
            if name not in before.files or name not in after.files:
                yield f"{name}: only in one of both"
            elif not np.array_equal(before[name], after[name], equal_nan=before[name].dtype.kind == "f"):
                yield f"{name}: not the same"


def trials(path: Path) -> dict[str, Any]:
    """The trials of a benchmark by name; the first line of the file has the settings, which are no result."""
    lines = (json.loads(line) for line in path.read_text().splitlines()[1:])
    return {f"{trial.get('name')} {trial.get('seed', '')}".strip(): trial for trial in lines}


def run_differences(old: Path, new: Path) -> Iterator[str]:
    """What differs between two folders of results: the summary, each trial, each run's arrays.

    Raises:
        RunMissingError: one of the folders lacks a file of the other, so that nothing could be compared.
    """
    for folder in (old, new):
        if not (folder / "summary.json").is_file():
            raise RunMissingError(f"{folder} has no summary.json: the run is missing or was cut off")
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in (old, new)]
    yield from differences(*summaries, "summary")
    if (old / "trials.jsonl").is_file():
        if not (new / "trials.jsonl").is_file():
            raise RunMissingError(f"{new} has no trials.jsonl")
        yield from differences(trials(old / "trials.jsonl"), trials(new / "trials.jsonl"), "trials")
    for path in sorted(old.glob("runs/*.npz")):
        if (other := new / "runs" / path.name).is_file():
            yield from (f"{path.name}: {line}" for line in array_differences(path, other))
        else:
            yield f"{path.name}: {ABSENT} in {new}"
