"""Options of commands that serve a page in the browser."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from pack_bringup.page import PageProcess

PORT, HOST = 8210, "127.0.0.1"

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
        envvar="PACKCELL_PAGE_TOKEN",
        help="What a browser must bring to see the page, at least 16 characters.",
    ),
]


def page_process(cell: str, live: bool, port: int, host: str = HOST, token: str = "") -> PageProcess | None:
    """The page that the options ask for; None without `--live`."""
    from pack_bringup.page import PageProcess

    return PageProcess(cell, port, host, token) if live else None
