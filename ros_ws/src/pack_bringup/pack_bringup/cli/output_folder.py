"""Refuses a folder that cannot take what a command leaves behind, before the command begins to work."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryFile

from pack_core.errors import ConfigError


def make_output_folder(folder: Path, taken_by: Iterable[str] = ()) -> None:
    """Make a folder if it does not exist yet, and make sure that files can be written there.

    Args:
        folder: what `--output` names.
        taken_by: names of files and folders of an earlier run, which must not be there.

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
        raise ConfigError(f"cannot write into {folder}: {error.strerror}; give another --output") from error
