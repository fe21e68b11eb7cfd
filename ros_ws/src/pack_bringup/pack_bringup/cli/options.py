"""Options that several commands have, and what follows from their values."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.outputs import check_json_file
from pack_bringup.cli.terminal import notice
from pack_core.addresses import LAST_DOMAIN, LOOPBACK, PAGE_PORT, PAGE_TOKEN_VARIABLE, check_token
from pack_core.errors import ConfigError
from pack_core.namespace import ROOT, checked_namespace
from pack_core.network import domain_in

if TYPE_CHECKING:
    from pack_bringup.viewers import PageProcess

Domain = Annotated[
    int | None,
    typer.Option(
        min=0, max=LAST_DOMAIN,
        help="ROS domain id; the environment's if not given. Ports of higher ones are Linux's to hand out.",
    ),
]  # fmt: skip


def domain_of(option: int | None) -> int:
    """The domain that an option names, else the environment's, else 0 as ROS has it."""
    return domain_in(os.environ) or 0 if option is None else option


def domain_words(option: int | None) -> str:
    """The option as other commands need it, after a space; empty if they do not need it."""
    return "" if option is None or option == domain_of(None) else f" --domain {option}"


Reset = Annotated[
    bool, typer.Option(help="Put the cell into the goal's scene first; --no-reset: as the cell stands.")
]


Network = Annotated[
    str,
    typer.Option(
        metavar="INTERFACE",
        help="Talk to other machines over this network interface, too. Default: this machine alone.",
    ),
]


Namespace = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Namespace of the cell, e.g. `left`: two cells of one ROS domain need one each. Default: none.",
        callback=checked_namespace,
    ),
]


@dataclass(frozen=True)
class CellAddress:
    """Which of the running cells a command is for.

    Attributes:
        domain: ROS domain id; None: the environment's.
        namespace: of the cell, as rcl writes it.
        network: the network of a cell on several machines; empty: this machine.
    """

    domain: int | None
    namespace: str = ROOT
    network: str = ""


def namespace_words(namespace: str) -> str:
    """The option as other commands need it, after a space; empty if they do not need it."""
    return "" if namespace == ROOT else f" --namespace {namespace.removeprefix('/')}"


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


RealTimeFactor = Annotated[
    float | None,
    typer.Option(
        min=0.0,
        help="Simulated seconds per second of wall clock; 0: as fast as possible. Default: see sim.yaml.",
    ),
]
Video = Annotated[
    bool, typer.Option(help="Render the run as MP4 and as an interactive replay, for the report.")
]
FreeDomain = Annotated[
    int | None,
    typer.Option(
        min=0, max=LAST_DOMAIN, help="ROS domain id. Default: the environment's, else one that is free."
    ),
]
RunFolder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="Folder for everything that the run leaves behind. Default: a new one below bags/.",
    ),
]


Jobs = Annotated[
    int, typer.Option(min=1, help="Trials at a time, each in a process of its own on this machine.")
]
Ray = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Run the trials on a Ray cluster instead: its address, `auto` for the one that this machine is "
        "part of, `local` to start one here.",
    ),
]
BenchmarkFolder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="Folder of the results. Default: one below bags/benchmarks/, named after the settings.",
    ),
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Delete the results that DIR has already and measure anew.")
]
JsonFile = Annotated[
    Path | None,
    typer.Option(
        "--json", metavar="FILE", help="Write the summary to this file, too.", callback=check_json_file
    ),
]


Live = Annotated[bool, typer.Option("--live", help="Serve a page that shows the cell in the browser.")]
Port = Annotated[int, typer.Option(min=1, max=65535, help="Port of the page, with --live.")]
Host = Annotated[
    str,
    typer.Option(
        help="Address on which the page listens, with --live. Others than this machine's need --token: "
        "who has it can operate the cell (docs/operate/viewing.md)."
    ),
]
Token = Annotated[
    str,
    typer.Option(
        envvar=PAGE_TOKEN_VARIABLE,
        help="What a browser must bring to see the page, at least 16 characters.",
    ),
]


def page_process(
    cell: str, live: bool, port: int, host: str = LOOPBACK, token: str = "", namespace: str = ROOT
) -> PageProcess | None:
    """The page that the options ask for; None without `--live`.

    Raises:
        ConfigError: the address needs a token, and there is none or a short one; or it is of no page.
    """
    from pack_bringup.viewers import PageProcess

    if live:
        check_token(host, token)
    elif (port, host) != (PAGE_PORT, LOOPBACK):
        raise ConfigError("--port or --host without --live; allowed: both, or neither of them")
    return PageProcess(cell, port, host, token, namespace) if live else None


Foxglove = Annotated[
    bool,
    typer.Option("--foxglove", help="Serve live topics to Foxglove, read only, to this machine only."),
]
