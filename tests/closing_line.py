"""The last line of a run of the tests, in plain words."""

from __future__ import annotations

import time
from collections.abc import Sequence

import pytest


def closing_line(
    passed: int, failed: int, skip_reasons: Sequence[str], seconds: float, *, is_cut_off: bool = False
) -> str:
    """What a run of the tests found, in one sentence.

    Args:
        passed: Number of tests that passed.
        failed: Number of tests that failed or could not be started.
        skip_reasons: Why each skipped test was skipped.
        seconds: Duration of the run [s].
        is_cut_off: Whether the run ended before all tests had run, as after Ctrl-C.
    """
    minutes, rest = divmod(round(seconds), 60)
    time_taken = f"{minutes} min {rest} s" if minutes else f"{rest} s"
    if failed:
        found = f"{failed} of {passed + failed} tests failed in {time_taken}; they are listed above"
    elif is_cut_off:
        found = f"stopped before the end; the first {passed} tests passed in {time_taken}"
    else:
        found = f"all {passed} tests passed in {time_taken}"
    if skip_reasons:
        # What stands behind a colon is how to change it, which pytest's own summary says in full.
        short = {reason.partition(":")[0] for reason in skip_reasons}
        found += f"; {len(skip_reasons)} skipped ({'; '.join(sorted(short))})"
    return f"PackCell: {found}"


class ClosingLine:
    """Prints the closing line when everything else has been printed."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._started = time.monotonic()
        self._is_cut_off = False

    def pytest_keyboard_interrupt(self) -> None:
        self._is_cut_off = True

    def pytest_unconfigure(self) -> None:
        reporter = self._config.pluginmanager.get_plugin("terminalreporter")
        if reporter is None or self._config.option.collectonly:
            return
        count = {outcome: len(reporter.stats.get(outcome, ())) for outcome in ("passed", "failed", "error")}
        reasons = [
            report.longrepr[2].removeprefix("Skipped: ") for report in reporter.stats.get("skipped", ())
        ]
        if sum(count.values()) + len(reasons):
            seconds = time.monotonic() - self._started
            failed = count["failed"] + count["error"]
            line = closing_line(count["passed"], failed, reasons, seconds, is_cut_off=self._is_cut_off)
            reporter.write_line(line)
