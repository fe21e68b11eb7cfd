"""Runs tests against a mutated copy of the sources, in forks of a process that has the libraries loaded.

cosmic-ray itself starts an interpreter for each mutant; most of its time would go into importing them.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

import pytest

STEP_S = 0.05
SITE = f"{os.sep}.venv{os.sep}"
"""In the paths of the libraries."""


class Tests:
    """The unit tests of a part, run again and again.

    Args:
        tests: files of tests.
        modules: files of the copy that are mutated.
        scratch: folder for what the runs write.

    Raises:
        RuntimeError: the tests fail without any mutation, or import the modules from elsewhere.
    """

    def __init__(self, tests: Sequence[Path], modules: Sequence[Path], scratch: Path) -> None:
        self._tests, self._scratch = [str(test) for test in tests], scratch
        began = time.monotonic()
        if not self.pass_within(600.0):
            raise RuntimeError(f"tests fail without any mutation:\n{self.output}")
        imported: dict[str, str] = json.loads(self._imported.read_text())
        if missing := {str(module) for module in modules} - set(imported.values()):
            raise RuntimeError(f"the tests do not import {', '.join(sorted(missing))}")
        _import_all(name for name, file in imported.items() if SITE in file)
        self.timeout = 30.0 + 10.0 * (time.monotonic() - began)
        """When a run is given up [s]: ten times as long as without mutation, on a machine with other work."""

    @property
    def output(self) -> str:
        """What the last run printed."""
        return (self._scratch / "output").read_text(errors="replace")

    @property
    def _imported(self) -> Path:
        return self._scratch / "imported"

    def pass_within(self, timeout: float) -> bool:
        """Whether all tests pass; False also where they take longer than `timeout` [s]."""
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            self._run()
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                return os.waitstatus_to_exitcode(status) == 0
            time.sleep(STEP_S)
        os.killpg(child, signal.SIGKILL)
        os.waitpid(child, 0)
        return False

    def _run(self) -> None:
        """Run the tests in this process, which then ends."""
        code = 1
        try:
            os.setsid()  # a process group of its own, to be killed with what it starts
            output = os.open(self._scratch / "output", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(output, 1)
            os.dup2(output, 2)
            importlib.invalidate_caches()
            plugins = [
                word for name in ("cacheprovider", "xdist", "benchmark") for word in ("-p", f"no:{name}")
            ]
            code = int(pytest.main(["-x", "-q", "--tb=short", *plugins, *self._tests]))
            files = {name: getattr(module, "__file__", None) for name, module in sys.modules.items()}
            self._imported.write_text(json.dumps({name: file for name, file in files.items() if file}))
        finally:
            os._exit(code)


def _import_all(names: Iterable[str]) -> None:
    for name in names:
        with suppress(Exception):  # some are imported by their parents only
            importlib.import_module(name)
