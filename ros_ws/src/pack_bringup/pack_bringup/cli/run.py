"""`pack run` and `pack executables`: start one executable of a package, and what can be started."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from pack_bringup.cli.options import Network, prepare_network
from pack_bringup.graph.executables import executables_of, find_executable, packages_with_executables

app = typer.Typer()

PASS_THROUGH = {"allow_interspersed_args": False, "ignore_unknown_options": True}


@app.command(context_settings=PASS_THROUGH)
def run(
    package: Annotated[str, typer.Argument(help="A package, e.g. `pack_sim`.")],
    executable: Annotated[str, typer.Argument(help="One of its executables, e.g. `sim_node`.")],
    arguments: Annotated[list[str] | None, typer.Argument(help="Passed on as they are.")] = None,
    network: Network = "",
) -> None:
    """Start one executable of a package, found as `ros2 run` finds it.

    - `pack run pack_sim sim_node`
    - `pack run pack_sim sim_node --ros-args -p real_time_factor:=0.5`
    - `pack run pack_mpc mpc_node --ros-args --params-file config/nodes/packing/mpc.yaml`
    - `pack run --network eth0 pack_mpc mpc_node`, for a cell that is spread over several machines
    """
    path = str(find_executable(package, executable))
    prepare_network(network)
    rest = arguments or []
    passed_on = rest[1:] if rest[:1] == ["--"] else rest
    os.execve(path, [path, *passed_on], os.environ)


@app.command()
def executables(
    package: Annotated[str | None, typer.Argument(help="A package; all of them if not given.")] = None,
) -> None:
    """List what `pack run` can start, one `PACKAGE EXECUTABLE` a line."""
    for name in [package] if package else packages_with_executables():
        for path in executables_of(name):
            typer.echo(f"{name} {path.name}")
