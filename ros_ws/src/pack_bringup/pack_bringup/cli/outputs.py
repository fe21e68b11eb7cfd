"""Where commands leave what they found: folders that can take it, and JSON for other programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from pack_core.errors import ConfigError


def make_output_folder(
    folder: Path, taken_by: Iterable[str] = (), advice: str = "give another --output"
) -> None:
    """Make a folder if it does not exist yet, and make sure that files can be written there.

    Args:
        folder: what `--output` names.
        taken_by: names of files and folders of an earlier run, which must not be there.
        advice: what to do where it cannot be written to.

    Raises:
        ConfigError: it is a file, cannot be made or written to, or holds an earlier run.
    """
    if there := [name for name in taken_by if (folder / name).exists()]:
        raise ConfigError(
            f"{folder} holds an earlier run ({', '.join(there)}); give --output a folder that does not exist "
            "yet, or delete that run"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ConfigError(f"cannot write into {folder}: {error.strerror}; {advice}") from error


def check_json_file(path: Path | None) -> Path | None:
    """Make the folder of the file that `--json` names, if it names one; the option's callback.

    Raises:
        ConfigError: the file cannot be written.
    """
    if path is not None:
        if path.is_dir():
            raise ConfigError(f"cannot write into {path}: it is a folder; give --json a file")
        make_output_folder(path.parent, advice="give another --json")
    return path


def write_json(path: Path, values: Any) -> None:
    """Write plain values, for other programs."""
    path.write_text(json.dumps(values, indent=2) + "\n")


def command_line() -> str:
    """As it was given."""
    return " ".join(["pack", *sys.argv[1:]])
