"""How the tests share the machine: several workers at once, and the tests marked `alone` one by one."""

from __future__ import annotations

import fcntl
import gc
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import pytest
from hypothesis import settings

from closing_line import ClosingLine

FIRST_TO_LAST = ("e2e", "contract", "integration", "unit", "architecture", "replay")
"""Folders in the order in which they run: first those whose tests wait, for simulated time or for a node to
start, and those with the longest tests ahead."""
COMPUTING = tuple(f"tests/{folder}/" for folder in ("unit", "architecture", "replay"))
"""Folders whose tests wait for nothing: one worker runs these while the others wait."""
LOCKS = pytest.StashKey[Path]()


def pytest_configure(config: pytest.Config) -> None:
    """Set hypothesis up; make the folder of the locks, or take that of the process that started this one."""
    # an example that takes long on a busy machine is no failure: speed is measured by the benchmarks
    settings.register_profile("packcell", deadline=None)
    settings.load_profile("packcell")
    started_with = getattr(config, "workerinput", {})
    folder = started_with.get("locks") or tempfile.mkdtemp(prefix="packcell_tests_")
    config.stash[LOCKS] = Path(folder)
    if not started_with:
        config.pluginmanager.register(ClosingLine(config))


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist
def pytest_configure_node(node: object) -> None:
    """Tell a worker where the locks are."""
    node.workerinput["locks"] = str(node.config.stash[LOCKS])  # type: ignore[attr-defined]


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the locks with the process that made them."""
    if not hasattr(config, "workerinput"):
        for path in config.stash[LOCKS].iterdir():
            path.unlink()
        config.stash[LOCKS].rmdir()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Order the folders; `alone` tests come last, when no worker has anything else to do."""
    tests = Path(__file__).parent

    def rank(item: pytest.Item) -> tuple[bool, int]:
        folder = item.path.relative_to(tests).parts[0]
        position = FIRST_TO_LAST.index(folder) if folder in FIRST_TO_LAST else len(FIRST_TO_LAST)
        return item.get_closest_marker("alone") is not None, position

    items.sort(key=rank)


def pytest_collection_finish() -> None:
    """Leave the tests and modules, which stay to the end, out of what is searched for garbage.

    A search through half a million objects takes 0.3 s, in which a node under test is late.
    """
    gc.collect()
    gc.freeze()


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Give whole files to a worker, and all demos to one, as each of them starts five or six processes.

    The last worker runs what computes as long as there is any, so that the processor is busy all the time.
    """
    from xdist.scheduler import LoadFileScheduling

    class Scheduler(LoadFileScheduling):
        def _assign_work_unit(self, node: object) -> None:
            computing = next((scope for scope in self.workqueue if scope.startswith(COMPUTING)), None)
            if node is self.nodes[-1] and computing is not None:
                self.workqueue.move_to_end(computing, last=False)
            super()._assign_work_unit(node)

        def _split_scope(self, nodeid: str) -> str:
            return "demos" if "_demo.py::" in nodeid else super()._split_scope(nodeid)

    return Scheduler(config, log)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Run an `alone` test while no other worker runs any."""
    locks = item.config.stash[LOCKS]
    is_alone = item.get_closest_marker("alone") is not None
    with (locks / "queue").open("a") as queue, (locks / "machine").open("a") as machine:
        # Whoever wants the machine alone stands in the queue until it is free, so that nobody overtakes.
        with _locked(queue, fcntl.LOCK_EX):
            fcntl.flock(machine, fcntl.LOCK_EX if is_alone else fcntl.LOCK_SH)
        return (yield)


@pytest.fixture(scope="session")
def compiled(pytestconfig: pytest.Config) -> None:
    """The rearrangement planners are compiled, by one worker, so that no test's budget is spent on it."""
    from pack_planner.rearrangement.planning import warm_up

    with (pytestconfig.stash[LOCKS] / "compiling").open("a") as file, _locked(file, fcntl.LOCK_EX):
        warm_up()


@contextmanager
def _locked(file: IO[str], kind: int) -> Iterator[None]:
    fcntl.flock(file, kind)
    try:
        yield
    finally:
        fcntl.flock(file, fcntl.LOCK_UN)
