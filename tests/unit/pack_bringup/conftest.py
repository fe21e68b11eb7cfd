import os
from pathlib import Path

import pytest

PEEL = """#!/bin/sh
for argument in "$@"; do echo "[$argument]"; done
"""


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An ament prefix with one package, `fruit`: `peel`, which shows its arguments, and a text file."""
    marker = tmp_path / "share" / "ament_index" / "resource_index" / "packages" / "fruit"
    marker.parent.mkdir(parents=True)
    marker.touch()
    folder = tmp_path / "lib" / "fruit"
    folder.mkdir(parents=True)
    (folder / "peel").write_text(PEEL)
    (folder / "peel").chmod(0o755)
    (folder / "notes.txt").touch(mode=0o644)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{os.environ['AMENT_PREFIX_PATH']}")
    return tmp_path
