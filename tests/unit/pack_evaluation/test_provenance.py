"""Which code a result says that it was made with."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from pack_evaluation import provenance

NOBODY = ("-c", "user.name=nobody", "-c", "user.email=nobody@localhost")


def git(root: Path, *arguments: str) -> str:
    command = ["git", "-C", str(root), *NOBODY, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("source.py", "results/one.json"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("before")
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "--message", "begin")
    monkeypatch.setattr(provenance, "project_root", lambda: tmp_path)
    return tmp_path


def test_a_published_result_does_not_make_a_checkout_dirty(checkout: Path) -> None:
    (checkout / "results" / "one.json").write_text("after")
    assert provenance.checked_out_commit() == git(checkout, "rev-parse", "HEAD")


def test_a_changed_source_makes_a_checkout_dirty(checkout: Path) -> None:
    (checkout / "source.py").write_text("after")
    assert provenance.checked_out_commit() == git(checkout, "rev-parse", "HEAD") + "-dirty"


def test_without_git_the_commit_is_unknown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(provenance, "project_root", lambda: tmp_path)
    assert provenance.checked_out_commit() == "unknown"
