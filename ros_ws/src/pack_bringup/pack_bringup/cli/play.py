"""`pack play`: a recording into the live graph."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.progress import BarColumn, Progress, TextColumn

from pack_bringup.cli.options import Domain, Namespace, Network, Port, prepare_network
from pack_bringup.cli.terminal import end_as_by_ctrl_c
from pack_core.addresses import LOOPBACK, PAGE_PORT

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pack_bringup.recording.playback import Playback
    from pack_bringup.recording.ros.bag_player import BagPlayer
    from pack_core.ros.contracts.contract import Contract

app = typer.Typer()


@app.command()
def play(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="A run's or a bag's folder, or an .mcap file.")],
    clock: Annotated[
        bool, typer.Option("--clock", help="Publish /clock as well, for nodes on simulated time.")
    ] = False,
    rate: Annotated[float, typer.Option(min=0.001, help="Simulated seconds per second of wall clock.")] = 1.0,
    topics: Annotated[
        list[str] | None,
        typer.Option("--topic", metavar="TOPIC", help="Publish only this topic; may be repeated."),
    ] = None,
    node: Annotated[
        str | None, typer.Option("--for", metavar="NODE", help="Publish only what this node listens to.")
    ] = None,
    cell: Annotated[
        str, typer.Option(help="Cell whose nodes count as alive; that of the recording by default.")
    ] = "",
    start: Annotated[float, typer.Option("--from", help="Simulated time to begin at [s].")] = 0.0,
    end: Annotated[float, typer.Option("--to", help="Simulated time to end at [s].")] = float("inf"),
    wait: Annotated[
        float, typer.Option(min=0.0, help="Longest wait for somebody to listen to every topic [s].")
    ] = 5.0,
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
    live: Annotated[
        bool, typer.Option("--live", help="Show the recording in the browser instead of publishing it.")
    ] = False,
    port: Port = PAGE_PORT,
) -> None:
    """Publish a recording, so that nodes run against it as they do against the simulator.

    Quality of service and stamps are those of the recording. The nodes that sent it count as alive meanwhile.
    What a node under test publishes itself must not be played: `--for` or `--topic` leaves it out.

    - `pack play bags/samples/packing --for perception --clock`, with `pack up packing --only perception`
      in another terminal and the same ROS_DOMAIN_ID
    - `pack play bags/samples/packing --live`, to look at it in the browser, with a slider over its time
    - `pack play bags/packing_20260101_120000_seed0 --rate 0.3 --topic /scene --topic /sim/truth`
    """
    if live:
        show_recording(bag, port, rate, start)
        return
    prepare_network(network)
    from pack_bringup.recording.playback import load_playback
    from pack_bringup.recording.ros.bag_player import BagPlayer
    from pack_core.ros.contracts.table import wiring_of
    from pack_evaluation.record import cell_of

    wiring = wiring_of(cell or cell_of(bag))
    heard = () if node is None else heard_by(node, wiring)
    playback = load_playback(bag, topics, heard, start=start, end=end)
    senders = sorted({s for c in wiring if c.name in playback.topics for s in c.sources} - {node, "all"})
    end_as_by_ctrl_c()
    with BagPlayer(playback, clock=clock, stand_in=senders, domain=domain, namespace=namespace) as player:
        if unheard := player.wait_for_listeners(wait):
            typer.echo(f"nobody listens to {', '.join(unheard)}")
        try:
            count = _play(player, playback, rate)
        except KeyboardInterrupt:
            typer.echo("stopped")
            raise typer.Exit(130) from None
    cut = " of a recording that was cut off" if playback.is_cut else ""
    typer.echo(f"{count} messages{cut} played, {playback.duration:.1f} s of simulated time")


def show_recording(bag: Path, port: int, rate: float, start: float) -> None:
    """Serve the page of a recording until Ctrl-C; no node and no graph is needed for it."""
    from threading import Event

    from pack_bringup.viewers import announcement
    from pack_evaluation.record import cell_of
    from pack_viewer.bag_page import BagPage
    from pack_viewer.web_server import open_server

    end_as_by_ctrl_c()
    server = open_server(port, f"PackCell · {cell_of(bag)}")
    try:
        page = BagPage(server, bag, rate=rate, start=start)
        typer.echo(f"{announcement(LOOPBACK, port)}  (Ctrl-C ends it)")
        page.run(Event())
    except KeyboardInterrupt:
        typer.echo("stopped")
    finally:
        server.stop()


def heard_by(node: str, wiring: Iterable[Contract]) -> list[str]:
    """The recorded topics that a node listens to, /clock apart.

    Raises:
        ConfigError: the cell has no such node, or it listens to nothing that is recorded.
    """
    from pack_core.errors import ConfigError
    from pack_core.ros.contracts.contract import Kind
    from pack_core.ros.contracts.table import is_picture

    topics = [c for c in wiring if c.kind is Kind.TOPIC and (c.recorded or is_picture(c))]
    heard = {c.name: c.targets for c in topics if "all" not in c.targets}
    if names := [name for name, targets in heard.items() if node in targets]:
        return names
    known = sorted({target for targets in heard.values() for target in targets} - {"user", "recorder"})
    raise ConfigError(f"no recorded topic goes to a node '{node}'; allowed: {', '.join(known)}")


def _play(player: BagPlayer, playback: Playback, rate: float) -> int:
    from pack_core import stamps

    columns = (TextColumn("playing"), BarColumn(), TextColumn("{task.fields[time]:7.2f} s"))
    with Progress(*columns) as bar:
        first = stamps.to_seconds(playback.start_ns)
        task = bar.add_task("playing", total=playback.duration, time=first)
        return int(player.play(rate, lambda t: bar.update(task, completed=t - first, time=t)))
