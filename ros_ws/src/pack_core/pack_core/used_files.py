"""Which files of the project a process uses: modules that it imported, and files that it read.

Python tells an audit hook of every file that is opened and of every folder that is listed (PEP 578). The
modules of a process are in `sys.modules`. What no result depends on is left out: `pack_bringup`, which only
starts, records and shows what is measured.

A process that is started for a measurement tells what it used in a file of the folder that the variable
`PACKCELL_USED_FILES` names.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pack_core.paths import project_root

VARIABLE = "PACKCELL_USED_FILES"
"""Of the environment: the folder into which a process tells what it used; not set: it tells nothing."""
SOURCES, CONFIG = "ros_ws/src", "config"
COMMANDS = f"{SOURCES}/pack_bringup/"
EVENTS = frozenset({"open", "os.listdir", "os.scandir"})

_read: set[str] = set()
"""What this process opened and listed since `watch`, as it named it."""
_before: frozenset[str] | None = None
"""Modules that were imported before `watch`; None: it has not been called."""


def watch() -> None:
    """Note from now on what this process reads; an audit hook stays as long as the process lives."""
    global _before
    if _before is None:
        _before = frozenset(sys.modules)
        sys.addaudithook(_note)


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if event in EVENTS and isinstance(arguments[0], str):
        _read.add(arguments[0])


def used_since_watch() -> frozenset[str]:
    """Files of the project that this process imported or read since `watch`; none if it was not called."""
    if _before is None:
        return frozenset()
    return _modules(name for name in list(sys.modules) if name not in _before) | data_files(_read)


def used_by_process() -> frozenset[str]:
    """Files of the project that this process imported at any time, or read since `watch`."""
    return _modules(list(sys.modules)) | data_files(_read)


def watch_if_asked() -> None:
    """Watch, if the environment names a folder into which to tell."""
    if VARIABLE in os.environ:
        watch()


def tell_if_asked() -> None:
    """Write what this process has used so far into the folder that the environment names, if it names one."""
    if (folder := os.environ.get(VARIABLE)) is None:
        return
    path = Path(folder) / f"{os.getpid()}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    written = path.with_suffix(".part")
    written.write_text(json.dumps(sorted(used_by_process())))
    written.replace(path)


def told(folder: Path) -> frozenset[str]:
    """What all processes that told into a folder have used."""
    return frozenset(used for path in folder.glob("*.json") for used in json.loads(path.read_text()))


def data_files(paths: Iterable[str]) -> frozenset[str]:
    """Files and listed folders (these end with a slash) of the configuration, and data beside the sources."""
    found = set()
    for path in list(paths):
        name = _inside(path)
        is_data = name.startswith(f"{SOURCES}/") and Path(name).suffix not in {".py", ""}
        if "__pycache__" in name:
            continue
        if is_data or name == CONFIG or name.startswith(f"{CONFIG}/"):
            found.add(f"{name}/" if (project_root() / name).is_dir() else name)
    return frozenset(found)


def _modules(names: Iterable[str]) -> frozenset[str]:
    files = (getattr(sys.modules.get(name), "__file__", None) for name in names)
    inside = (_inside(file) for file in files if file)
    return frozenset(path for path in inside if path.startswith(SOURCES) and not path.startswith(COMMANDS))


def _inside(path: str) -> str:
    """A path relative to the project, behind all links; empty for one outside of it."""
    real = os.path.realpath(path)
    root = os.path.realpath(project_root())
    return os.path.relpath(real, root) if real.startswith(root + os.sep) else ""
