"""The option `--network` of commands that join a live graph."""

from __future__ import annotations

from typing import Annotated

import typer

from pack_bringup.cli.terminal import notice

Network = Annotated[
    str,
    typer.Option(
        metavar="INTERFACE",
        help="Talk to other machines over this network interface, too. Default: this machine alone.",
    ),
]


def environment_of(network: str) -> dict[str, str]:
    """Environment variables for `--network`, after saying what it opens; none if it was not given."""
    from pack_bringup.graph.network import network_environment, network_warning

    if not network:
        return {}
    notice(network_warning(network), typer.colors.YELLOW, is_error=True)
    return network_environment(network)
