"""The option `--network` of commands that join a live graph."""

from __future__ import annotations

import os
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


def prepare_network(network: str = "") -> None:
    """Put this command's environment, and so that of what it starts, in order before it joins a graph.

    Args:
        network: what `--network` names; empty: this machine alone.

    Raises:
        PackError: no such interface, or a variable has a value with which no node starts.
    """
    from pack_bringup.graph.network import network_environment
    from pack_core.network import enforce

    if network:
        os.environ.update(network_environment(network))
    for sentence in enforce(os.environ):
        notice(sentence, typer.colors.YELLOW, is_error=True)
