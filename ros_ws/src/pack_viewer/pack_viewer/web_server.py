"""The page's web server: on this machine alone, or behind a token, and closed to foreign web pages.

A browser lets any web page open a WebSocket to any address, so without a check a page from elsewhere could
press the buttons of this one. Every request is therefore judged before it is answered: by the address that
the browser asked for (`Host`, against names that are made to point here), by the page that asks (`Origin`),
and by the token where there is one.
"""

from __future__ import annotations

import hmac
import http
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any
from urllib.parse import parse_qs, urlsplit

import viser
import websockets.asyncio.server
from websockets.http11 import Request, Response

from pack_core.addresses import LOCAL_NAMES, LOOPBACK, check_token
from pack_core.errors import ConfigError

LARGEST_MESSAGE = 8 * 1024 * 1024
"""Largest message that a browser may send [bytes]: a picture of the scene, or a piece of an uploaded file."""
COOKIE = "packcell_token"


@dataclass(frozen=True)
class ConnectionGuard:
    """Decides who may connect.

    Attributes:
        port: the server's port.
        token: what others than this machine must know; empty: only this machine is served, without a token.
    """

    port: int
    token: str = ""

    def refusal(self, request: Request) -> str:
        """Why a request is refused, in words; empty where it may be answered."""
        host, origin = request.headers.get("Host", ""), request.headers.get("Origin")
        if not self.token and host not in self._addresses:
            return f"this page is served at {' and '.join(self._addresses)} only"
        # A page that this server served names this server as its origin; other clients than browsers none.
        if origin is not None and origin != f"http://{host}":
            return "a page from elsewhere may not connect"
        if self.token and not self._knows_token(request):
            return "the token is missing or wrong: open the address with ?token=..."
        return ""

    @property
    def _addresses(self) -> list[str]:
        return [f"{name}:{self.port}" for name in LOCAL_NAMES]

    def _knows_token(self, request: Request) -> bool:
        given = [*parse_qs(urlsplit(request.path).query).get("token", []), *_cookies(request, COOKIE)]
        # In constant time, so that how long a refusal takes does not tell how much of a guess was right.
        return any(hmac.compare_digest(text.encode(), self.token.encode()) for text in given)


def open_server(port: int, label: str, *, host: str = LOOPBACK, token: str = "") -> viser.ViserServer:
    """Start the web server.

    Args:
        port: to listen on; 0: any free one, for a scene that nobody is to look at here.
        label: title of the page.
        host: address to listen on; others than this machine's own need a token.
        token: what a browser must bring, in the address or in the cookie that it then gets.

    Raises:
        ConfigError: the port is taken, or others could reach the page without a token.
    """
    check_token(host, token)
    # It logs a traceback for everybody who connects and asks for nothing, as who looks for open ports does.
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
    with _guarded(ConnectionGuard(port, token)) as is_guarded, redirect_stdout(StringIO()):
        server = PrivateServer(host=host, port=port, label=label, verbose=False)
    if not is_guarded():
        server.stop()
        raise ConfigError("viser opened its server in another way than expected, so nobody would be refused")
    if port and server.get_port() != port:  # viser takes the next free port without a word
        server.stop()
        raise ConfigError(f"port {port} is taken; choose another one, or end the page that has it")
    return server


class PrivateServer(viser.ViserServer):
    """A server that no browser can ask for a public address."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refused: any browser may ask for it, and it would open the page to everybody."""
        return None

    def stop(self) -> None:
        """Close the server, without viser's line on the terminal."""
        with redirect_stdout(StringIO()):
            super().stop()


@contextmanager
def _guarded(guard: ConnectionGuard) -> Iterator[Callable[[], bool]]:
    """While a server is built, have it ask `guard` first; yields whether one did.

    viser has no setting for it: it calls `serve` of websockets by its full name.
    """
    plain, used = websockets.asyncio.server.serve, []

    def serve(*args: Any, **kwargs: Any) -> Any:
        used.append(True)
        answer = kwargs["process_request"]
        kwargs["process_request"] = lambda connection, request: _judged(guard, answer, connection, request)
        return plain(*args, **{**kwargs, "max_size": LARGEST_MESSAGE})

    websockets.asyncio.server.serve = serve  # type: ignore[assignment, misc]
    try:
        yield lambda: bool(used)
    finally:
        websockets.asyncio.server.serve = plain  # type: ignore[misc]


def _judged(guard: ConnectionGuard, answer: Callable[..., Any], connection: Any, request: Request) -> Any:
    if reason := guard.refusal(request):
        return connection.respond(http.HTTPStatus.FORBIDDEN, f"refused: {reason}\n")
    response = answer(connection, request)
    if isinstance(response, Response):
        _harden(response, guard.token)
    return response


def _harden(response: Response, token: str) -> None:
    """No other page may show this one in a frame, and a browser that brought the token keeps it."""
    response.headers["Content-Security-Policy"] = "frame-ancestors 'none'"
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers["Referrer-Policy"] = "no-referrer"
    if token:
        response.headers["Set-Cookie"] = f"{COOKIE}={token}; HttpOnly; SameSite=Strict; Path=/"


def _cookies(request: Request, name: str) -> list[str]:
    pairs = [pair.strip().partition("=") for pair in request.headers.get("Cookie", "").split(";")]
    return [value for key, _, value in pairs if key == name]
