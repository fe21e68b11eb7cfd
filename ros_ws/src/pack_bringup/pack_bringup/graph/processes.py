"""Runs the nodes of a graph as separate processes, and starts again those that died."""

from __future__ import annotations

import os
import shlex
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from queue import Queue
from threading import Condition, Thread
from types import TracebackType
from typing import Any, Self, TextIO

from honcho.colour import get_colours
from honcho.printer import Message, Printer
from honcho.process import Process

from pack_core.errors import PackError

ENVIRONMENT = {"MALLOC_ARENA_MAX": "2", "MALLOC_MMAP_THRESHOLD_": str(256 * 2**10)}
"""What holds unless our own environment says otherwise, so that nodes do not grow in an hour.

Nodes begin and end threads, and for a new one the C library may reserve another arena of memory, which a
process then keeps. It also keeps what pictures and rollouts leave free, in pieces, unless blocks of their
size [byte] are reserved by themselves and given back at once.
"""


class ProcessGroup:
    """Named processes that are started together, can be stopped one by one, and never outlive us.

    The death of one is written to the log and leaves the others running, as in any ROS graph.
    """

    def __init__(
        self,
        commands: Mapping[str, Sequence[str]],
        *,
        environment: Mapping[str, str] | None = None,
        output: TextIO = sys.stdout,
    ) -> None:
        """Prepare the processes; `environment` adds to our own, `output` takes their log lines."""
        self._printer = Printer(output, width=max(map(len, commands)), colour=not os.environ.get("NO_COLOR"))
        self._events: Queue[Any] = Queue()
        self._changed = Condition()
        self._pids: dict[str, int] = {}
        self._exit_codes: dict[str, int] = {}
        self._env = {**ENVIRONMENT, **os.environ, "PYTHONUNBUFFERED": "1", **(environment or {})}
        self._commands, self._colours = dict(commands), dict(zip(commands, get_colours(), strict=False))
        self._processes = {name: self._prepare(name) for name in commands}
        self._relaying = Thread(target=self._relay, daemon=True)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    @property
    def exit_codes(self) -> dict[str, int]:
        """By name, how those ended that did; -9 for SIGKILL and so on."""
        with self._changed:
            return dict(self._exit_codes)

    @property
    def running(self) -> list[str]:
        """The names of those still alive."""
        return [name for name in self._processes if name not in self.exit_codes]

    def pid(self, name: str) -> int:
        """The process id of `name`, dead or alive."""
        if name not in self._processes:
            raise PackError(f"no process '{name}'; there are: {', '.join(self._processes)}")
        return self._pids[name]

    def start(self) -> None:
        """Start every process, and return once all have one; to be called in the main thread."""
        _pass_on_no_ignored_ctrl_c()
        self._relaying.start()
        for name in self._processes:
            self._begin(name)
        with self._changed:
            self._changed.wait_for(lambda: len(self._pids) == len(self._processes))

    def restart(self, name: str, command: Sequence[str] | None = None) -> None:
        """Start a process that has ended once more, and return once it has a process id.

        Args:
            name: of the process.
            command: another command than before; None: the same.

        Raises:
            PackError: it still runs, or there is none of this name.
        """
        before = self.pid(name)
        if name in self.running:
            raise PackError(f"process '{name}' still runs; only one that has ended can be started again")
        if command is not None:
            self._commands[name] = command
        with self._changed:
            self._exit_codes.pop(name)
        self._processes[name] = self._prepare(name)
        self._begin(name)
        with self._changed:
            self._changed.wait_for(lambda: self._pids[name] != before)

    def wait(self, timeout: float | None = None, *, count: int | None = None) -> bool:
        """Wait until `count` processes (all, if not given) have ended; False if `timeout` [s] came first."""
        wanted = len(self._processes) if count is None else count
        with self._changed:
            return self._changed.wait_for(lambda: len(self._exit_codes) >= wanted, timeout)

    def signal(self, name: str, number: signal.Signals) -> None:
        """Send a signal to one process and its children, if it is still alive."""
        pid = self.pid(name)
        if name in self.running:
            with suppress(ProcessLookupError):  # it has ended, which is not told yet
                os.killpg(pid, number)

    def stop(self, grace: float = 10.0) -> None:
        """End all as Ctrl-C would, and kill what is still alive after `grace` [s] of wall clock.

        What they have written is then in the output, which may be closed.
        """
        for number in (signal.SIGINT, signal.SIGKILL):
            for name in self.running:
                self.signal(name, number)
            if self.wait(grace):
                break
        self._events.put(None)
        self._relaying.join()

    def _prepare(self, name: str) -> Process:
        command = _shell_command(self._commands[name])
        return Process(command, name=name, colour=self._colours.get(name), env=self._env)

    def _begin(self, name: str) -> None:
        Thread(target=self._processes[name].run, args=(self._events,), daemon=True).start()

    def _relay(self) -> None:
        while (message := self._events.get()) is not None:
            if message.type == "line":
                self._write(message)
                continue
            with self._changed:
                if message.type == "start":
                    self._pids[message.name] = message.data["pid"]
                else:
                    self._exit_codes[message.name] = message.data["returncode"]
                    self._report(message.name, f"ended with exit code {message.data['returncode']}")
                self._changed.notify_all()

    def _report(self, name: str, text: str) -> None:
        self._write(Message("line", text, datetime.now(), name, None))

    def _write(self, message: Message) -> None:
        with suppress(OSError, ValueError):  # a closed pipe or a full disk must not end our watch
            self._printer.write(message)


def _pass_on_no_ignored_ctrl_c() -> None:
    """Have what we start heed Ctrl-C, even where we ignore it because a shell runs us in the background.

    What we ignore, the processes we start ignore, too, and `stop` could not end them; a handler is not
    passed on. Ours does nothing, so that we go on as before.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, lambda _number, _frame: None)


def _shell_command(command: Sequence[str]) -> str:
    """The command as a shell runs it, so that it ends when we are killed."""
    return "exec setpriv --pdeathsig TERM " + shlex.join(command)


MOST = 3
"""Restarts of one node within `SPAN`; one that dies once more is left dead, as it would die again."""
SPAN = 60.0
"""Over which restarts are counted [s of wall clock]."""


class Restarts:
    """Watches a group of processes.

    Args:
        group: the processes.
        say: is told what was done, in a sentence.
        clock: wall clock [s].
    """

    def __init__(
        self, group: ProcessGroup, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._group, self._say, self._clock = group, say, clock
        self._times: dict[str, list[float]] = {}
        self._given_up: set[str] = set()

    def restart_dead(self) -> None:
        """Start again what has died since the last call; a process that ended in order stays ended."""
        for name, code in self._group.exit_codes.items():
            if code != 0 and name not in self._given_up:
                self._restart(name, code)

    def _restart(self, name: str, code: int) -> None:
        now = self._clock()
        times = self._times[name] = [at for at in self._times.get(name, []) if now - at < SPAN]
        if len(times) >= MOST:
            self._given_up.add(name)
            self._say(
                f"node '{name}' died again (exit code {code}), {MOST} restarts in a minute did not help: it "
                "stays ended; its last log lines say why"
            )
            return
        times.append(now)
        self._group.restart(name)
        self._say(f"node '{name}' died (exit code {code}) and was started again, restart {len(times)}")
