"""Where programs of a cell can be reached."""

from __future__ import annotations

LOOPBACK = "127.0.0.1"
"""This machine alone."""
LAST_DOMAIN = 101
"""The ROS domains from 0 on whose ports leave Linux' ephemeral ones alone."""
PAGE_PORT = 8210
"""Of the page in the browser; not viser's own, 8080, which is often taken."""
FOXGLOVE_PORT = 8765
"""Of the server for Foxglove."""
PAGE_TOKEN_VARIABLE = "PACKCELL_PAGE_TOKEN"
"""The environment has the page's token: everybody in the graph can read a node's parameters, and everybody on
the machine its command line."""


def page_address(host: str, port: int, token: str = "") -> str:
    """What a browser opens."""
    return f"http://{host}:{port}" + (f"/?token={token}" if token else "")
