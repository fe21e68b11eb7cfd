"""`pack up`: start the nodes of a cell."""

from __future__ import annotations

import signal
from typing import Annotated, Any

import typer

from pack_bringup.cli.network_option import Network, environment_of
from pack_bringup.cli.page_options import HOST, PORT, Host, Live, Port, Token, page_process
from pack_bringup.graph.graph import load_graph, parse_overrides, preset_overrides
from pack_bringup.graph.processes import ProcessGroup
from pack_core.config import merged

app = typer.Typer()


@app.command()
def up(
    cell: Annotated[str, typer.Argument(help="Cell to start, e.g. `packing`: a file of config/graphs.")],
    only: Annotated[
        list[str] | None, typer.Option(metavar="NODE", help="Start this node only; may be repeated.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NODE.PARAM=VALUE", help="Override a parameter; may be repeated."),
    ] = None,
    preset: Annotated[
        str,
        typer.Option(
            help="Run under the conditions of this file of config/presets (docs/packing/presets.md)."
        ),
    ] = "",
    domain: Annotated[
        int | None, typer.Option(min=0, max=101, help="ROS domain id; the environment's if not given.")
    ] = None,
    network: Network = "",
    live: Live = False,
    port: Port = PORT,
    host: Host = HOST,
    token: Token = "",
) -> None:
    """Start the nodes of a cell, each a process of its own, until Ctrl-C.

    Log lines carry the node's name. A node that dies is named; the others stay up, and the exit code is 1.

    - `pack up packing`
    - `pack up packing --set sim.seed=3 --set sim.real_time_factor=0.5`
    - `pack up packing --preset hardware`
    - `pack up packing --only sim --only perception --domain 7`
    - `pack up packing --live`, to watch and operate the cell in the browser (docs/viewing.md)
    - `pack up packing --network eth0`, for nodes on other machines
    """
    graph = load_graph(cell)
    graph = graph.only(only) if only else graph
    names = [node.name for node in graph.nodes]
    conditions = {name: given for name, given in preset_overrides(cell, preset).items() if name in names}
    commands = graph.commands(merged(conditions, parse_overrides(settings or [])))
    environment = environment_of(network)
    environment |= {} if domain is None else {"ROS_DOMAIN_ID": str(domain)}
    if page := page_process(cell, live, port, host, token):
        commands |= page.commands()
        environment |= page.environment()
        typer.echo(page.announcement)
    died: dict[str, int] = {}
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _as_ctrl_c)
    try:
        with ProcessGroup(commands, environment=environment) as group:
            try:
                group.wait()
            finally:
                died = group.exit_codes
    except KeyboardInterrupt:
        typer.echo("stopped")
    if died:
        typer.secho(f"died before the end: {', '.join(died)}", fg=typer.colors.RED, err=True)
        raise typer.Exit(1)


def _as_ctrl_c(*_: Any) -> None:
    raise KeyboardInterrupt
