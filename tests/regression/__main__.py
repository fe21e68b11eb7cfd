"""Record what a version of the cells does, and compare two versions to the last digit.

`make regression ARGS="record bags/regression/before"` before a change, the same with `after` behind it, then
`make regression ARGS="compare bags/regression/before bags/regression/after"`. Both records must come from one
machine: processors round differently.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from regression.comparison import RunMissingError, run_differences

ORDERS = [part for number in ("01", "05", "09") for part in ("--order", f"config/orders/order_{number}.json")]
BENCHMARKS = {
    "packing": "packing --scenes 6 --seed 50",
    "packing_hardware": "packing --scenes 6 --seed 50 --preset hardware",
    "packing_smaller_container": "packing --scenes 4 --seed 50 --container 0.24x0.19",
    "packing_fill": "packing --fill --scenes 1 --seed 50",
    "packing_ilqr": "packing --scenes 1 --seed 50 --optimizer ilqr",
    "packing_uninformed_physics": "packing --scenes 1 --seed 50 --method uninformed_physics",
    "palletizing_noise": f"palletizing {' '.join(ORDERS)} --no-vision",
    "palletizing_real": "palletizing --order config/orders/order_02.json --preset real --no-vision",
    "palletizing_thesis": "palletizing --order config/orders/order_03.json --profile thesis --no-vision",
    "palletizing_vision": "palletizing --order config/orders/order_03.json",
    "blocks_execution": "blocks --blocks 4 --instances 2 --seed 50 --budget 20 --execute",
    "blocks_plans": "blocks --blocks 9 --instances 10 --seed 50 --budget 20",
    "blocks_pirs": "blocks --blocks 4 --instances 2 --seed 50 --method pirs --budget 60",
}
"""A few runs of every cell, by name: the arguments of `pack benchmark`. Together a quarter of an hour."""
SAMPLE = "evaluation_of_the_sample"
app = typer.Typer(help=__doc__, no_args_is_help=True, add_completion=False)


def command_of(name: str, folder: Path) -> list[str]:
    """The command line that leaves the results of a run in its folder."""
    if name == SAMPLE:
        results = ["--output", str(folder), "--json", str(folder / "summary.json"), "--no-video"]
        return ["pack", "evaluate", "bags/samples/packing", *results]
    return ["pack", "benchmark", *BENCHMARKS[name].split(), "--output", str(folder)]


@app.command()
def record(
    output: Annotated[Path, typer.Argument(help="Folder for the results; what it has already is kept.")],
    only: Annotated[list[str] | None, typer.Option(help="Names of runs; default: all.")] = None,
) -> None:
    """Run every benchmark of the table and keep its results."""
    names = only or [*BENCHMARKS, SAMPLE]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns) as bar:
        task = bar.add_task("", total=len(names))
        for name in names:
            bar.update(task, description=name)
            folder = output / name
            folder.mkdir(parents=True, exist_ok=True)
            with (output / f"{name}.log").open("w") as log:
                subprocess.run(command_of(name, folder), stdout=log, stderr=log, check=True)
            bar.advance(task)


@app.command()
def compare(
    old: Annotated[Path, typer.Argument(help="Folder that `record` wrote before the change.")],
    new: Annotated[Path, typer.Argument(help="Folder that `record` wrote after it.")],
    most: Annotated[int, typer.Option(min=1, help="Differences of a run that are shown.")] = 12,
) -> None:
    """Say for each run whether it is the same but for the wall clock; exit code 1 if one is not.

    A run that neither folder has is left out; one that one of them lacks, or that did not come to its end,
    is named.
    """
    console = Console()
    recorded = [name for name in [*BENCHMARKS, SAMPLE] if (old / name).is_dir() or (new / name).is_dir()]
    if not recorded:
        raise typer.BadParameter(f"neither {old} nor {new} has a run of `record`")
    is_same = True
    for name in recorded:
        try:
            found = list(run_differences(old / name, new / name))
        except RunMissingError as error:
            is_same = False
            console.print(f"{name}: not compared: {error}", markup=False, soft_wrap=True)
            continue
        is_same = is_same and not found
        console.print(f"{name}: {f'{len(found)} differences' if found else 'the same'}")
        for line in found[:most]:
            console.print(f"  {line}", markup=False, soft_wrap=True)
    raise typer.Exit(int(not is_same))


if __name__ == "__main__":
    app()
