"""`pack status`: what runs in a ROS domain, since when, and in which state."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import typer

from pack_bringup.cli.options import Domain, Namespace, Network, domain_of, prepare_network
from pack_bringup.cli.terminal import show_table

if TYPE_CHECKING:
    from pack_interfaces.msg import NodeStatus

app = typer.Typer()

DISCOVERY = 1.0
"""Shortest time to listen [s of wall clock]: not all nodes are known to run before they are heard."""
PATIENCE = 5.0
"""Longest time to listen for nodes that are known to run [s of wall clock]."""


@app.command()
def status(domain: Domain = None, namespace: Namespace = "", network: Network = "") -> None:
    """Show what runs in a ROS domain: each node, since when it runs, its state and its health.

    Cells of this machine in other domains and namespaces are named below. The exit code is 0 if a cell runs
    and all its nodes are ready and healthy, else 1.

    - `pack status`
    - `pack status --domain 7`
    - `pack status --namespace left`
    """
    prepare_network(network)
    from pack_bringup.graph.running import (
        all_cell_nodes,
        cell_nodes_here,
        described,
        place,
        running_cells,
    )
    from pack_bringup.ros.status_listener import StatusListener

    where = domain_of(domain)
    with StatusListener(where, namespace) as listener:
        known, running = all_cell_nodes(), cell_nodes_here(where, namespace)
        listener.spin_until(lambda: False, DISCOVERY)
        listener.spin_until(lambda: running <= listener.statuses.keys() & listener.health.keys(), PATIENCE)
        nodes = [item for name, item in sorted(listener.statuses.items()) if name in known]
        faults = {name: item.message for name, item in listener.health.items() if item.level != b"\x00"}
    if nodes:
        names = [node.name for node in nodes]
        typer.echo(f"{place(where, namespace)}: {described(names)}")
        show_table(("node", "runs for", "state", "for", "what"), _rows(nodes, faults))
    else:
        typer.echo(f"{place(where, namespace)}: no cell runs")
    for other, what in running_cells().items():
        if other != (where, namespace):
            typer.echo(f"{place(*other)}: {what}")
    is_well = nodes and not faults and all(node.state >= node.READY for node in nodes)
    raise typer.Exit(0 if is_well else 1)


def _rows(nodes: list[NodeStatus], faults: dict[str, str]) -> list[tuple[str, ...]]:
    from pack_bringup.ros.status_listener import STATE_WORDS

    return [
        (
            node.name, _duration(node.started), STATE_WORDS[node.state], _duration(node.since),
            "; ".join(filter(None, (node.waits_for, faults.get(node.name, "")))),
        )
        for node in nodes
    ]  # fmt: skip


def _duration(since: float) -> str:
    """Time since then, in the unit that suits it."""
    seconds = max(0.0, time.time() - since)
    if seconds < 60:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"
