"""Which cells run on this machine, in which ROS domains, and which domains are free."""

from __future__ import annotations

import os
import socket
from collections.abc import Collection, Iterable, Mapping

from pack_bringup.graph.graph import load_graph
from pack_core.addresses import LAST_DOMAIN
from pack_core.cells import CELLS
from pack_core.errors import PackError
from pack_core.namespace import ROOT
from pack_core.network import domain_in
from pack_core.ros.watch.local_nodes import nodes_on_this_machine

DOMAINS = LAST_DOMAIN - 1
"""Domain ids from 1 on that are tried."""


def choose_domain(environment: Mapping[str, str]) -> int:
    """The environment's ROS_DOMAIN_ID, else a free one.

    Raises:
        PackError: it is no domain, or every domain is in use.
    """
    if (given := domain_in(environment)) is not None:
        return given
    for k in range(DOMAINS):
        domain = 1 + (os.getpid() + k) % DOMAINS
        if is_free(domain):
            return domain
    raise PackError(f"all ROS domains from 1 to {DOMAINS} are in use on this machine; set ROS_DOMAIN_ID")


def is_free(domain: int) -> bool:
    """Whether no participant of this machine listens on the domain.

    The first one binds UDP port 7410 + 250 * domain (DDS Interoperability Wire Protocol, 9.6.2).
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", 7410 + 250 * domain))
        except OSError:
            return False
    return True


def check_domain_is_free(
    domain: int, cell: str, nodes: Iterable[str], running: Mapping[int, Collection[str]] | None = None,
    *, namespace: str = ROOT,
) -> None:  # fmt: skip
    """Refuse to start nodes among those of another cell, or among nodes of the same names.

    Nodes of the same cell with other names are allowed: a cell may be started in parts.

    Args:
        domain: ROS domain id in which the nodes are to run.
        cell: theirs.
        nodes: their names.
        running: names of the nodes that run on this machine by domain; None: found now.
        namespace: of the nodes that are to run, as rcl writes it.

    Raises:
        PackError: the domain is taken; the text names what runs there, and a domain that is free.
    """
    everywhere = nodes_on_this_machine() if running is None else running
    here = _cells_in(everywhere.get(domain, ())).get(namespace, set())
    if here & set(nodes) or here - names_of(cell):
        raise PackError(
            f"{place(domain, namespace)} is taken: {described(here)} there. End it (Ctrl-C where it was "
            f"started), or use another domain: --domain {free_domain(everywhere)}, or ROS_DOMAIN_ID in the "
            "environment; or a namespace of its own: --namespace NAME"
        )


def cell_nodes_here(domain: int, namespace: str = ROOT) -> set[str]:
    """Names of nodes of any cell that run on this machine in a ROS domain and a namespace."""
    return _cells_in(nodes_on_this_machine().get(domain, ())).get(namespace, set())


def nodes_here(cell: str, domain: int, namespace: str = ROOT) -> set[str]:
    """Names of a cell's nodes that run on this machine in a ROS domain and a namespace."""
    return names_of(cell) & cell_nodes_here(domain, namespace)


def running_cells() -> dict[tuple[int, str], str]:
    """What runs on this machine in words, by ROS domain and namespace."""
    return {
        (domain, namespace): described(names)
        for domain, everybody in sorted(nodes_on_this_machine().items())
        for namespace, names in sorted(_cells_in(everybody).items())
    }


def place(domain: int, namespace: str) -> str:
    """Where something runs, in words."""
    return f"ROS domain {domain}" + ("" if namespace == ROOT else f", namespace {namespace}")


def _cells_in(lifelines: Iterable[str]) -> dict[str, set[str]]:
    """Those that are nodes of cells, by namespace, from their names on this machine, as in `left/sim`."""
    known, found = all_cell_nodes(), dict[str, set[str]]()
    for lifeline in lifelines:
        folder, _, name = lifeline.rpartition("/")
        if name in known:
            found.setdefault(f"/{folder}", set()).add(name)
    return found


def cell_of(nodes: Collection[str]) -> str:
    """The cell that these nodes belong to; empty if more than one may have them, or none."""
    fitting = [cell for cell in CELLS if set(nodes) <= names_of(cell)]
    return fitting[0] if len(fitting) == 1 else ""


def described(nodes: Collection[str]) -> str:
    """A sentence's beginning about running nodes, as in "the packing cell (mpc, sim) runs"."""
    listed = ", ".join(sorted(nodes))
    cell = cell_of(nodes)
    return f"the {cell} cell ({listed}) runs" if cell else f"nodes of a cell ({listed}) run"


def free_domain(running: Mapping[int, Collection[str]]) -> int:
    """The lowest ROS domain from 1 on that nobody on this machine uses.

    Raises:
        PackError: every domain is in use.
    """
    for domain in range(1, DOMAINS + 1):
        if domain not in running and is_free(domain):
            return domain
    raise PackError(f"all ROS domains from 1 to {DOMAINS} are in use on this machine")


def names_of(cell: str) -> set[str]:
    """The names of a cell's nodes."""
    return {node.name for node in load_graph(cell).nodes}


def all_cell_nodes() -> set[str]:
    """The names that nodes of any cell have."""
    return set().union(*map(names_of, CELLS))
