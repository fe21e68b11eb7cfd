"""`pack results`: the published figures, which of them are of this code, and how to measure the others."""

from __future__ import annotations

import os
import shlex
import subprocess
from collections import Counter, defaultdict
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from pack_bringup.cli.options import Jobs, Ray
from pack_bringup.cli.terminal import end_as_by_ctrl_c, notice, show_table

if TYPE_CHECKING:
    from pack_lockstep.benchmarking.results_folder import ResultsFolder
    from pack_lockstep.results.definitions import BenchmarkDefinition, Definitions
    from pack_lockstep.results.published import PublishedResult, Standing

app = typer.Typer()
results = typer.Typer(
    help="List the published figures, and measure again what is not of this code.\n\n"
    "The tables of benchmarks in README and on the pages of results come from files, "
    "results/CELL/NAME.json. Each names the sources, the configuration and the packages that its run used, "
    "and is valid as long as these are what they were; comments and docstrings do not count.\n\n"
    "- `pack results` lists all with valid, stale or missing, and the reason\n"
    "- `pack results run` measures what is not valid, those that take longest first\n"
    "- `pack results run packing/ideal blocks --jobs 2`\n"
    "- `pack results tables` writes the tables of the pages from the files",
)
app.add_typer(results, name="results")

Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="[NAME]...", help="Names of results/benchmarks.yaml, or cells. Default: all."),
]
COLOURS = {"valid": "green", "stale": "yellow", "missing": "red"}


@results.callback(invoke_without_command=True)
def _list(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        show([])


@results.command("list")
def show(names: Names = None) -> None:
    """List results with their state, version and date.

    - `pack results list packing`
    """
    from pack_lockstep.results.definitions import load_definitions
    from pack_lockstep.results.published import ResultState

    rows, reasons = [], defaultdict[str, list[str]](list)
    counts, left = Counter[str](), 0.0
    for name, definition in load_definitions().chosen(names or ()).items():
        found, standing = _standing(name, definition)
        state = standing.state.value
        counts[state] += 1
        left += 0.0 if state == ResultState.VALID.value else definition.minutes
        if standing.reason:
            reasons[standing.reason].append(name)
        origin = (found.version, found.date) if found else ("", "")
        rows.append((name, Text(state, COLOURS[state]), *origin, f"{definition.minutes:g}"))
    show_table(("name", "state", "version", "date", "min"), rows)
    for reason, whose in reasons.items():
        typer.echo(f"stale because {reason}: {', '.join(whose)}")
    said = ", ".join(f"{counts[state.value]} {state.value}" for state in ResultState if counts[state.value])
    typer.echo(f"{said}; what is not valid takes about {left:.0f} minutes of one core")


@results.command()
def run(
    names: Names = None,
    jobs: Jobs = 1,
    ray: Ray = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Also what is valid; all trials are run again.")
    ] = False,
) -> None:
    """Measure what is stale or missing, and publish each result as soon as it is there.

    Trials are kept below bags/results: after Ctrl-C the same command goes on where it was, unless sources
    or packages changed that the trials depend on. A benchmark that fails does not keep the others from
    being run; the exit code is then 1.

    - `pack results run --jobs 2`
    - `pack results run packing/ideal`
    """
    from pack_lockstep.results.definitions import load_definitions
    from pack_lockstep.results.published import ResultState

    definitions = load_definitions()
    wanted = {
        name: definition
        for name, definition in definitions.chosen(names or ()).items()
        if everything or _standing(name, definition)[1].state is not ResultState.VALID
    }
    if not wanted:
        typer.echo("all of these results are valid; --all measures them anew")
        return
    end_as_by_ctrl_c()  # the benchmark would go on without this process
    failed = []
    for number, (name, definition) in enumerate(wanted.items(), 1):
        minutes = definition.minutes / (1 if definition.is_live else definition.jobs or jobs)
        notice(f"[{number} of {len(wanted)}] {name}, about {minutes:.0f} minutes", typer.colors.CYAN)
        if not _measure(name, definition, definitions, jobs=jobs, ray=ray, anew=everything):
            failed.append(name)
    if failed:
        notice(f"could not be measured: {', '.join(failed)}", typer.colors.RED, is_error=True)
        raise typer.Exit(1)
    typer.echo("now: pack results tables")


def _measure(
    name: str, definition: BenchmarkDefinition, definitions: Definitions, *, jobs: int, ray: str | None,
    anew: bool,
) -> bool:  # fmt: skip
    """Run a benchmark in a process of its own and publish its summary; whether it came to its end.

    Trials that are kept below bags/results are gone on with, unless they are of other code, or `anew` is set.
    """
    from pack_core.paths import bags_path, project_root
    from pack_lockstep.benchmarking.pools import LocalPool
    from pack_lockstep.benchmarking.results_folder import ResultsFolder
    from pack_lockstep.benchmarking.sources import Traced

    folder = ResultsFolder(bags_path() / "results" / name)
    sources = frozenset[str]()
    if definition.before:
        prepare = Traced(_pack, name.partition("/")[0], "studies")
        ((_, sources),) = LocalPool(1).run(prepare, [shlex.split(definition.before)])
    command = ["pack", "benchmark", *definition.arguments, "--output", str(folder.path)]
    if not definition.is_live:
        command += ["--jobs", str(definition.jobs or jobs)]
        command += [] if ray is None else ["--ray", ray]
    if folder.path.is_dir() and (anew or not _is_of_this_code(folder)):
        command.append("--fresh")
    if subprocess.run(command, check=False, cwd=project_root()).returncode != 0:
        return False
    folder.add_sources(sources)
    if changed := folder.changed_sources():
        what = f"{changed[0]} changed while {name} was measured: the figures would be of neither version"
        notice(what, typer.colors.RED, is_error=True)
        return False
    _publish(name, definition, definitions, folder.path)
    return True


def _is_of_this_code(folder: ResultsFolder) -> bool:
    """Whether trials that are kept are of the sources and packages that are here."""
    from pack_evaluation.provenance import installed_versions
    from pack_lockstep.results.published import differing_package

    if not folder.sources or folder.changed_sources():
        return False
    if not folder.is_at(folder.path):
        return True  # of goals of running nodes, which are always sent anew
    return not differing_package(folder.kept(()).origin.get("versions", {}), installed_versions())


def _pack(words: list[str]) -> None:
    """Run a command of `pack` in this process."""
    from pack_bringup.cli.main import app as commands
    from pack_core.paths import project_root

    os.chdir(project_root())
    commands(words, standalone_mode=False)


def _publish(name: str, definition: BenchmarkDefinition, definitions: Definitions, folder: Path) -> None:
    """Write the file of a result, and a line of the history."""
    from pack_core.text.json_text import parse_json
    from pack_evaluation.provenance import checked_out_commit, installed_versions, machine, project_version
    from pack_lockstep.benchmarking.results_folder import SUMMARY, ResultsFolder
    from pack_lockstep.results import history
    from pack_lockstep.results.definitions import results_path
    from pack_lockstep.results.published import PublishedResult, file_of

    summary = parse_json((folder / SUMMARY).read_text(), str(folder / SUMMARY))
    result = PublishedResult(
        command=definition.line, date=date.today().isoformat(),
        version=project_version(), commit=checked_out_commit(), machine=machine(),
        packages=installed_versions(), summary=summary, sources=ResultsFolder(folder).sources,
    )  # fmt: skip
    result.save(file_of(name, results_path()))
    row = {"date": result.date, "version": result.version, "commit": result.commit[:8], "name": name}
    history.append(results_path(), {**row, **definitions.trend_of(name, summary)})


@results.command()
def tables(
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit code 1 if a page differs from the files.")
    ] = False,
) -> None:
    """Write the tables of README and of the pages of results from the files.

    - `pack results tables`
    """
    from pack_core.paths import project_root
    from pack_evaluation.provenance import project_version
    from pack_lockstep.results.definitions import load_definitions
    from pack_lockstep.results.pages import pages, with_tables

    found = {name: _load(name) for name in load_definitions().benchmarks}
    there = {name: result for name, result in found.items() if result is not None}
    differing = 0
    for page in pages(project_root()):
        before = page.read_text()
        after = with_tables(before, there, project_version())
        if after != before:
            differing += 1
            typer.echo(f"{page.relative_to(project_root())} {'differs' if check else 'is written'}")
            if not check:
                page.write_text(after)
    if check and differing:
        raise typer.Exit(1)


@results.command()
def plot(
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Default: docs/images/results_history.png."),
    ] = None,
) -> None:
    """Draw success, time, force and error of all results over the versions, from results/history.csv."""
    from pack_core.paths import project_root
    from pack_lockstep.results.definitions import results_path
    from pack_lockstep.results.history import PLOT, write_plot

    path = output or project_root() / "docs" / "images" / PLOT
    write_plot(results_path(), path)
    typer.echo(str(path))


def _load(name: str) -> PublishedResult | None:
    from pack_lockstep.results.definitions import results_path
    from pack_lockstep.results.published import file_of, load_result

    return load_result(file_of(name, results_path()))


def _standing(name: str, definition: BenchmarkDefinition) -> tuple[PublishedResult | None, Standing]:
    from pack_evaluation.provenance import installed_versions
    from pack_lockstep.results.published import ResultState, Standing

    result = _load(name)
    if result is None:
        return None, Standing(ResultState.MISSING)
    return result, result.standing(definition.line, installed_versions())
