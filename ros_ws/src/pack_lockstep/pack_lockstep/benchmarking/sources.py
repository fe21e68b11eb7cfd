"""Benchmarks whose work tells what of the project it used, and what counts as a change of that."""

from __future__ import annotations

import ast
import hashlib
import io
import json
import tokenize
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Generic, TypeVar

import yaml

from pack_core.cells import cell_part
from pack_core.paths import project_root
from pack_core.used_files import used_by_process, watch

JobT = TypeVar("JobT")
ResultT = TypeVar("ResultT")

DIGITS = 16
"""Hexadecimal digits of a digest: two different files share one with a probability of 1e-19."""


@dataclass(frozen=True)
class Traced(Generic[JobT, ResultT]):
    """A benchmark's work that also returns what of the project it used.

    Attributes:
        work: runs one job.
        cell, studies: the cell's part that makes figures of the results; what it uses counts, too.
    """

    work: Callable[[JobT], ResultT]
    cell: str
    studies: str

    def __call__(self, job: JobT) -> tuple[ResultT, frozenset[str]]:
        """The result of a job, and the files that this process has used so far."""
        watch()
        cell_part(self.cell, self.studies)
        result = self.work(job)
        return result, used_by_process()


def digests(paths: Iterable[str]) -> dict[str, str]:
    """The digest of each of these files and folders of the project by its path; empty for a missing one."""
    return {name: _digest_at(project_root() / name) for name in sorted(paths)}


def _digest_at(path: Path) -> str:
    return _digest_once(path, path.stat().st_mtime_ns) if path.exists() else ""


@cache
def _digest_once(path: Path, _changed: int) -> str:
    """Many results depend on the same files; `_changed` is when a file last did."""
    return digest(path)


def digest(path: Path) -> str:
    """Digest of what a file says: comments, docstrings and empty lines of Python and YAML do not count.

    Of a folder it is that of the names in it, so that a file more or less shows.
    """
    if path.is_dir():
        content = "\n".join(sorted(entry.name for entry in path.iterdir() if entry.name != "__pycache__"))
        return _digest(content.encode())
    if path.suffix == ".py":
        return _digest(code_of(path.read_text()).encode())
    if path.suffix == ".yaml":
        return _digest(json.dumps(yaml.safe_load(path.read_text()), default=str).encode())
    return _digest(path.read_bytes())


def fingerprint(sources: Mapping[str, str]) -> str:
    """One digest for all: of every path with its own digest."""
    return _digest("\n".join(f"{path} {sources[path]}" for path in sorted(sources)).encode())


def code_of(source: str) -> str:
    """A module's text without comments, docstrings and empty lines.

    The text is cut rather than parsed and printed, so that every version of Python says the same.
    """
    lines = source.splitlines(keepends=True)
    starts = {
        (node.lineno, node.col_offset)
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for token in reversed(list(tokenize.generate_tokens(io.StringIO(source).readline))):
        is_docstring = token.type == tokenize.STRING and token.start in starts
        if token.type == tokenize.COMMENT or is_docstring:
            _cut(lines, token.start, token.end)
    return "\n".join(line.rstrip() for line in "".join(lines).splitlines() if line.strip())


def _cut(lines: list[str], start: tuple[int, int], end: tuple[int, int]) -> None:
    """Take out a span, given by line (from 1) and column."""
    (first, left), (last, right) = start, end
    lines[first - 1 : last] = [lines[first - 1][:left] + lines[last - 1][right:]]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:DIGITS]
