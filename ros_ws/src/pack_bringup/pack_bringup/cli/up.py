"""`pack up`: start the nodes of a cell."""

from __future__ import annotations

import os
import signal
import sys
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pack_bringup.cli.options import (
    Domain,
    Foxglove,
    Host,
    Live,
    Namespace,
    Network,
    Port,
    Token,
    domain_of,
    domain_words,
    namespace_words,
    page_process,
    prepare_network,
)
from pack_bringup.cli.outputs import make_output_folder
from pack_bringup.cli.terminal import end_as_by_ctrl_c, notice
from pack_bringup.graph.bring_up import Tee, wait_until_ready
from pack_bringup.graph.graph import conditions, load_graph, parse_overrides
from pack_bringup.graph.processes import ProcessGroup, Restarts
from pack_bringup.graph.running import check_domain_is_free
from pack_bringup.recording.run_record import Record
from pack_bringup.viewers import FOXGLOVE_ADDRESS, foxglove_command
from pack_core.addresses import LOOPBACK, PAGE_PORT
from pack_core.config import merged
from pack_core.paths import bags_path

if TYPE_CHECKING:
    from pack_bringup.ros.status_listener import StatusListener

app = typer.Typer()
RESTART_PERIOD = 0.2
"""How often it is checked whether a node has died [s of wall clock]."""


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
        typer.Option(help="Conditions by name, e.g. `hardware`: its file is in config/presets."),
    ] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Calibration of the cell, made under this preset (`pack calibrate`)."
        ),
    ] = None,
    record: Annotated[
        Record | None,
        typer.Option(help="Record while goals run, always, or never. Default: goals."),
    ] = None,
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
    live: Live = False,
    port: Port = PAGE_PORT,
    host: Host = LOOPBACK,
    token: Token = "",
    foxglove: Foxglove = False,
    restart: Annotated[
        bool, typer.Option("--restart", help="Start a node again that dies; the goal it worked on is lost.")
    ] = False,
) -> None:
    """Start the nodes of a cell, each a process of its own, until Ctrl-C.

    Log lines carry the node's name. Once every node has said that it is ready, it says so, and what to do
    next. A node that fails before that ends all of them, with its reason and the log (exit code 2). One that
    dies later is named; the others stay up, and the exit code is 1. With --restart it is started again. A ROS
    domain in which another cell runs is refused, with one that is free.

    - `pack up packing`
    - `pack up packing --set sim.seed=3 --set sim.real_time_factor=0.5`
    - `pack up packing --preset hardware`
    - `pack up palletizing --preset real --calibration calibration.yaml --set sim.seed=3`
    - `pack up packing --record never`
    - `pack up packing --only sim --only perception --domain 7`
    - `pack up packing --live`, to watch and operate the cell in the browser (docs/operate/viewing.md)
    - `pack up packing --foxglove`, for Foxglove and Lichtblick (docs/operate/rviz_and_foxglove.md)
    - `pack up packing --restart`, for a cell that is left alone
    - `pack up packing --network eth0`, for nodes on other machines
    - `pack up blocks --namespace left`, beside `pack up blocks --namespace right`
    """
    from pack_bringup.ros.status_listener import StatusListener

    graph = load_graph(cell)
    log = _log_file(cell, namespace)
    graph = graph.only(only) if only else graph
    names = [node.name for node in graph.nodes]
    given = {name: rest for name, rest in conditions(cell, preset, calibration).items() if name in names}
    if record is not None and "recorder" in names:
        given = merged(given, {"recorder": {"record": record}})
    commands = graph.commands(merged(given, parse_overrides(settings or [])), namespace)
    prepare_network(network)
    where = domain_of(domain)
    check_domain_is_free(where, cell, names, namespace=namespace)
    environment = {"ROS_DOMAIN_ID": str(where)}
    if page := page_process(cell, live, port, host, token, namespace):
        commands |= page.commands()
        environment |= page.environment()
        typer.echo(page.announcement)
    if foxglove:
        commands |= foxglove_command(cell, namespace)
        typer.echo(f"Foxglove: open the connection {FOXGLOVE_ADDRESS}, read only")
    end_as_by_ctrl_c(signal.SIGINT, signal.SIGTERM)
    next_step = ready_words(cell, names if only else [], domain_words(domain) + namespace_words(namespace))
    listener = StatusListener(where, namespace)
    died = _run(commands, environment, names, log, next_step, listener, with_restarts=restart)
    if died:
        notice(f"died before the end: {', '.join(died)}", typer.colors.RED, is_error=True)
        raise typer.Exit(1)


def ready_words(cell: str, only: list[str], domain: str) -> str:
    """What is said once all nodes are ready.

    Args:
        cell: theirs.
        only: names of the nodes where not all were started; these alone take no goal.
        domain: the options that other commands need to join them, after a space, or nothing.
    """
    if only:
        return f"ready: {', '.join(only)}; `pack status{domain}` shows what else runs, Ctrl-C ends it"
    return f"ready: `pack goal {cell}{domain}` sends a goal, Ctrl-C ends the cell"


def _run(
    commands: dict[str, list[str]], environment: dict[str, str], names: list[str], log: Path, next_step: str,
    statuses: StatusListener, *, with_restarts: bool,
) -> dict[str, int]:  # fmt: skip
    """Run the processes until Ctrl-C or until all have ended; exit codes of those that did by themselves."""
    os.environ.update(environment)  # for the listener, which is in this process
    died: dict[str, int] = {}
    try:
        with log.open("w") as file:
            output: Any = Tee(sys.stdout, file)
            with ProcessGroup(commands, environment=environment, output=output) as group:
                with statuses as listener:
                    wait_until_ready(group, listener, names, log, typer.echo)
                notice(next_step, typer.colors.GREEN)
                try:
                    _wait(group, with_restarts)
                finally:
                    died = group.exit_codes
    except KeyboardInterrupt:
        typer.echo("stopped")
    return died


def _wait(group: ProcessGroup, with_restarts: bool) -> None:
    """Return when all processes have ended; those that die meanwhile are started again if wished."""
    if not with_restarts:
        group.wait()
        return
    restarts = Restarts(group, lambda text: notice(text, typer.colors.YELLOW))
    while not group.wait(RESTART_PERIOD):
        restarts.restart_dead()


def _log_file(cell: str, namespace: str) -> Path:
    folder = bags_path() / "logs"
    make_output_folder(folder, advice="logs and recordings of running cells go there")
    return folder / f"{cell}{namespace.rstrip('/').replace('/', '_')}_{datetime.now():%Y%m%d_%H%M%S}.log"
