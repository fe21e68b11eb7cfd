"""Trials in a file, one JSON object a line, so that a benchmark goes on where it was interrupted."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pack_core.errors import ConfigError

SHOWN = 6
"""Differences that an error names."""


class TrialFile:
    """The settings of a benchmark in the first line, a trial in each line after it.

    Args:
        path: the file; made if it is missing.
        settings: all that decides the results; a file of other settings is refused.

    Raises:
        ConfigError: the file is of other settings, or no file of trials.
    """

    def __init__(self, path: Path, settings: Mapping[str, Any]) -> None:
        self._path = path
        wanted = json.loads(json.dumps({"settings": plain(settings)}))
        if not path.is_file():
            path.parent.mkdir(parents=True, exist_ok=True)
            self._write(wanted)
        header, self._trials = _read(path)
        if differences := _differences(header["settings"], wanted["settings"]):
            shown = "\n  ".join(differences[:SHOWN])
            more = f"\n  and {len(differences) - SHOWN} more" if len(differences) > SHOWN else ""
            raise ConfigError(
                f"{path} holds trials of other settings:\n  {shown}{more}\n"
                "give another --output, or --fresh to measure anew"
            )

    @property
    def trials(self) -> dict[str, dict[str, Any]]:
        """The trials so far by `name`."""
        return dict(self._trials)

    def add(self, trial: Mapping[str, Any]) -> None:
        """Write one more trial, which has a `name` of its own; it is on the disk on return."""
        values = plain(trial)
        self._write(values)
        self._trials[values["name"]] = values

    def _write(self, values: Mapping[str, Any]) -> None:
        with self._path.open("a") as file:
            file.write(json.dumps(values, allow_nan=False) + "\n")
            file.flush()
            os.fsync(file.fileno())


def read_trials(path: Path) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """The settings and the trials by name of a finished or interrupted benchmark.

    Raises:
        ConfigError: this is no file of trials.
    """
    header, trials = _read(path)
    return header["settings"], trials


def plain(value: Any) -> Any:
    """A value as strict JSON has it: what is not finite becomes text, tuples become lists."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _read(path: Path) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """The header and the trials; a last line that an interruption cut off is taken out of the file."""
    try:
        text = path.read_text()
        whole = text[: text.rfind("\n") + 1]
        if whole != text:
            os.truncate(path, len(whole.encode()))
        lines = [json.loads(line) for line in whole.splitlines()]
        return {"settings": lines[0]["settings"]}, {line["name"]: line for line in lines[1:]}
    except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
        raise ConfigError(
            f"{path} is no file of trials: {error!r}; delete it or give another --output"
        ) from error


def _differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    before, after = _flat(old), _flat(new)
    return [
        f"{key}: {before.get(key, 'nothing')} in the file, {after.get(key, 'nothing')} now"
        for key in [*after, *(key for key in before if key not in after)]
        if before.get(key, ...) != after.get(key, ...)
    ]


def _flat(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in values.items():
        flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat
