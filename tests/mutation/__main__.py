"""Mutation check: small faults are put into a copy of the sources, and unit tests must notice each of them.

`make mutation`, or `make mutation ARGS="norms stages"`. The exit code is 1 if less than 85 % were noticed.
"""

from __future__ import annotations

import difflib
import os
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from cosmic_ray.mutating import use_mutation
from rich.console import Console
from rich.progress import track
from rich.table import Table

from mutation.mutants import mutants
from mutation.parts import PARTS, Part
from mutation.trial import Tests

ROOT = Path(__file__).parents[2]
GOOD_SHARE = 0.85
CONSOLE = Console()


@dataclass(frozen=True)
class Outcome:
    """How many mutants were tried, and the changed lines of those that no test noticed."""

    tried: int
    survivors: list[str]

    @property
    def share(self) -> float:
        """Share of the mutants that were killed."""
        return 1.0 - len(self.survivors) / self.tried


def main(
    only: Annotated[
        list[str] | None, typer.Argument(help=f"Parts: {', '.join(PARTS)}; default: all.")
    ] = None,
    most: Annotated[int, typer.Option(min=1, help="Mutants of a part; of more, so many are drawn.")] = 60,
) -> None:
    """Try mutants of each part; print how many its unit tests killed, and the survivors."""
    names = only or list(PARTS)
    if unknown := set(names) - set(PARTS):
        raise typer.BadParameter(f"{', '.join(sorted(unknown))}; allowed: {', '.join(PARTS)}")
    sys.dont_write_bytecode = True  # two mutants of the same second and size would be taken for one
    with tempfile.TemporaryDirectory(prefix="packcell_mutation_") as folder:
        copy = Path(folder).resolve()
        os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(copy / "hypothesis")
        for part in ("ros_ws/src", "tests"):
            shutil.copytree(ROOT / part, copy / part)
        shutil.copy(ROOT / "pyproject.toml", copy)
        # This process imports none of these packages, so that every run of the tests does so anew.
        sys.path[:0] = [str(file.parent) for file in copy.glob("ros_ws/src/*/setup.py")]
        os.chdir(copy)
        outcomes = {name: check(PARTS[name], name, copy, most) for name in names}
    table = Table("part", "mutants", "killed", "share")
    for name, outcome in outcomes.items():
        killed = outcome.tried - len(outcome.survivors)
        table.add_row(name, str(outcome.tried), str(killed), f"{100 * outcome.share:.0f} %")
    CONSOLE.print(table)
    raise typer.Exit(int(any(outcome.share < GOOD_SHARE for outcome in outcomes.values())))


def check(part: Part, name: str, copy: Path, most: int) -> Outcome:
    """Try the mutants of one part in `copy`, a copy of the sources and tests."""
    modules = [copy / "ros_ws" / "src" / module for module in part.modules]
    tests = Tests([copy / "tests" / "unit" / test for test in part.tests], modules, copy)
    drawn, survivors = mutants(modules, most), []
    for mutant in track(drawn, description=name, console=CONSOLE):
        with use_mutation(mutant.module, mutant.operator, mutant.occurrence) as (before, after):
            if tests.pass_within(tests.timeout):
                survivors.append(changed_lines(before, after))
                CONSOLE.print(f"{mutant.module.name} {survivors[-1]}", markup=False, soft_wrap=True)
    return Outcome(len(drawn), survivors)


def changed_lines(before: str, after: str) -> str:
    """The lines that a mutation changed, with their numbers."""
    return "\n".join(
        list(difflib.unified_diff(before.splitlines(), after.splitlines(), n=0, lineterm=""))[2:]
    )


if __name__ == "__main__":
    typer.run(main)
