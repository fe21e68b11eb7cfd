"""Where programs of a cell can be reached."""

from __future__ import annotations

import re

from pack_core.errors import ConfigError

LOOPBACK = "127.0.0.1"
"""This machine alone."""
LAST_DOMAIN = 101
"""The ROS domains from 0 on whose ports leave Linux' ephemeral ones alone."""
LOCAL_NAMES = (LOOPBACK, "localhost")
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


def check_token(host: str, token: str) -> None:
    """Make sure that a page is shown to this machine alone, or to whoever has a token.

    Raises:
        ConfigError: the address is of others, too, without a token; or the token is none.
    """
    if host not in LOCAL_NAMES and not token:
        raise ConfigError(
            f"host '{host}' shows the page, with its buttons, to everybody who can reach this machine; "
            "give a token, too, or leave the host out"
        )
    # The token stands in addresses and in a cookie.
    if token and not re.fullmatch(r"[A-Za-z0-9_.~-]{16,}", token):
        raise ConfigError("the token is not one; allowed: 16 or more letters, digits and -_.~")
