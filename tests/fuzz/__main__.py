"""Fuzz: thousands of mutated files and messages through every reader, and a table of what became of them.

`make fuzz ARGS="--inputs 20000"`. The exit code is 1 if there was a traceback, a hang, or too much memory.
"""

from __future__ import annotations

import json
import multiprocessing
from collections import Counter
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from fuzz.targets import TARGETS
from fuzz.worker import ACCEPTED, ERROR, MEMORY, READY, TRACEBACK, Reading, work

HANG_S = 2.0
"""Processor time from which a reading counts as hanging [s]."""
PATIENCE_S = 20.0
"""Wall clock after which a worker is given up; long, because other processes may share the machine [s]."""
START_S = 180.0
HANG, DIED = "hang > 2 s", "died"
COLUMNS = (ERROR, ACCEPTED, TRACEBACK, HANG, MEMORY, DIED)
BAD = {TRACEBACK, HANG, MEMORY, DIED}


@dataclass
class Tally:
    """What became of a target's inputs."""

    counts: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    causes: dict[str, list[int]] = field(default_factory=dict)

    def add(self, number: int, reading: Reading) -> None:
        outcome = HANG if reading.seconds > HANG_S else reading.outcome
        self.counts[outcome] += 1
        self.slowest = max(self.slowest, reading.seconds)
        if outcome in BAD:
            self.causes.setdefault(f"{outcome}: {reading.cause}", []).append(number)


class Worker:
    """A process that reads one target's inputs; a new one takes its place when it hangs or dies."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._start()

    def read(self, number: int) -> Reading:
        try:
            self._connection.send(number)
            if self._connection.poll(PATIENCE_S):
                reading: Reading = self._connection.recv()
                return reading
            reading = Reading(HANG, PATIENCE_S, "no answer")
        except (EOFError, OSError):
            reading = Reading(DIED, 0.0, "the process ended")
        self.stop()
        self._start()
        return reading

    def stop(self) -> None:
        self._connection.close()
        self._process.kill()
        self._process.join()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection: Connection
        self._connection, other = context.Pipe()
        self._process = context.Process(target=work, args=(other, self._name), daemon=True)
        self._process.start()
        other.close()
        if not self._connection.poll(START_S) or self._connection.recv() != READY:
            raise RuntimeError(f"the reader of '{self._name}' did not start")


def main(
    inputs: Annotated[int, typer.Option(min=1, help="Inputs in all, shared among the readers.")] = 20_000,
    only: Annotated[list[str] | None, typer.Option(help="Names of readers; default: all.")] = None,
    first: Annotated[int, typer.Option(min=0, help="Number of each reader's first input.")] = 0,
    output: Annotated[Path | None, typer.Option(help="Write counts and causes to this file.")] = None,
) -> None:
    """Read mutated files and messages; print for each reader how many were refused, accepted, or harmful."""
    names = [target.name for target in TARGETS if not only or target.name in only]
    each = -(-inputs // len(names))
    tallies = {name: Tally() for name in names}
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, transient=True) as bar:
        task = bar.add_task("", total=each * len(names))
        for name in names:
            bar.update(task, description=name)
            worker = Worker(name)
            for number in range(first, first + each):
                tallies[name].add(number, worker.read(number))
                bar.advance(task)
            worker.stop()
            if output:  # after every reader: the whole takes a quarter of an hour
                found = {
                    n: {**t.counts, "slowest": t.slowest, "causes": t.causes} for n, t in tallies.items()
                }
                output.write_text(json.dumps(found, indent=1))
    show(tallies)
    raise typer.Exit(int(any(t.counts[column] for t in tallies.values() for column in BAD)))


def show(tallies: dict[str, Tally]) -> None:
    """Print the table, and below it every cause of harm with the number of an input that shows it."""
    console = Console()
    table = Table("reader", "tried", *COLUMNS, "slowest [s]")
    for name, tally in tallies.items():
        row = [str(tally.counts[column]) for column in COLUMNS]
        table.add_row(name, str(tally.counts.total()), *row, f"{tally.slowest:.2f}")
    total = sum((tally.counts for tally in tallies.values()), Counter[str]())
    table.add_row("all", str(total.total()), *(str(total[column]) for column in COLUMNS), "")
    console.print(table)
    for name, tally in tallies.items():
        for cause, numbers in sorted(tally.causes.items(), key=lambda item: -len(item[1]))[:12]:
            console.print(
                f"{name}: {len(numbers)} x {cause} (input {numbers[0]})", markup=False, soft_wrap=True
            )


if __name__ == "__main__":
    typer.run(main)
