"""The page's web server refuses whoever should not see it."""

import socket
from collections.abc import Iterator
from http.client import HTTPConnection

import pytest
import viser
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.http11 import Request
from websockets.sync.client import connect

from pack_core.errors import ConfigError
from pack_viewer.web_server import ConnectionGuard, open_server

TOKEN = "a-token-of-many-letters"
PROTOCOL = f"viser-v{viser.__version__}"


def request(path: str = "/", **headers: str) -> Request:
    return Request(path, Headers({"Host": "127.0.0.1:8000", **headers}))


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    opened = open_server(free_port(), "a page")
    yield opened
    opened.stop()


def test_the_page_itself_and_programs_on_this_machine_are_served() -> None:
    guard = ConnectionGuard(8000)
    assert guard.refusal(request()) == ""
    assert guard.refusal(request(Origin="http://127.0.0.1:8000")) == ""
    assert guard.refusal(request(Host="localhost:8000", Origin="http://localhost:8000")) == ""


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:8001", "https://127.0.0.1:8000", ""]
)
def test_a_page_from_elsewhere_is_refused(origin: str) -> None:
    assert "elsewhere" in ConnectionGuard(8000).refusal(request(Origin=origin))


@pytest.mark.parametrize("host", ["evil.example", "evil.example:8000", "", "127.0.0.1:9"])
def test_a_name_that_was_made_to_point_here_is_refused(host: str) -> None:
    headers = {"Host": host, "Origin": f"http://{host}"}
    assert "only" in ConnectionGuard(8000).refusal(Request("/", Headers(headers)))


def test_with_a_token_everybody_needs_it() -> None:
    guard = ConnectionGuard(8000, TOKEN)
    assert guard.refusal(request("/?token=a-token-of-many-letters")) == ""
    assert guard.refusal(request(Cookie=f"x=1; packcell_token={TOKEN}")) == ""
    for path in ("/", "/?token=", "/?token=a+token", f"/?other={TOKEN}"):
        assert "token" in guard.refusal(request(path))
    assert "elsewhere" in guard.refusal(request(f"/?token={TOKEN}", Origin="http://evil.example"))


def test_a_token_of_any_letters_is_compared_without_an_error() -> None:
    assert "token" in ConnectionGuard(8000, TOKEN).refusal(request("/?token=%C3%A4%F0%9F%98%80"))


def test_a_socket_opened_by_a_foreign_page_gets_403(server: viser.ViserServer) -> None:
    url = f"ws://127.0.0.1:{server.get_port()}"
    with pytest.raises(InvalidStatus) as refused:
        connect(url, origin="http://evil.example", subprotocols=[PROTOCOL])
    assert refused.value.response.status_code == 403
    assert b"elsewhere" in refused.value.response.body
    with connect(url, origin=f"http://127.0.0.1:{server.get_port()}", subprotocols=[PROTOCOL]) as socket_:
        assert socket_.recv(timeout=10)


def test_with_a_token_a_browser_keeps_it_in_a_cookie_and_no_other_gets_in() -> None:
    opened = open_server(free_port(), "a page", token=TOKEN)
    try:
        port = opened.get_port()
        assert got(port, "/")[0] == 403
        status, cookie = got(port, "/?token=a-token-of-many-letters")
        assert status == 200
        assert "HttpOnly" in cookie
        assert "SameSite=Strict" in cookie
        with pytest.raises(InvalidStatus):
            connect(f"ws://127.0.0.1:{port}", subprotocols=[PROTOCOL])
        kept = {"Cookie": cookie.split(";")[0]}
        with connect(f"ws://127.0.0.1:{port}", subprotocols=[PROTOCOL], additional_headers=kept) as socket_:
            assert socket_.recv(timeout=10)
    finally:
        opened.stop()


def got(port: int, path: str) -> tuple[int, str]:
    """Status of a page, and the cookie that comes with it."""
    connection = HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request("GET", path)
    answer = connection.getresponse()
    return answer.status, answer.getheader("Set-Cookie") or ""


def test_only_this_machine_is_listened_to(server: viser.ViserServer) -> None:
    assert server.get_host() == "127.0.0.1"


def test_whoever_looks_for_open_ports_leaves_no_traceback(caplog: pytest.LogCaptureFixture) -> None:
    server = open_server(free_port(), "a page")
    with socket.create_connection(("127.0.0.1", server.get_port())) as connection:
        connection.shutdown(socket.SHUT_WR)  # gone without a request
        assert connection.recv(1) == b""  # the server has given it up
    with pytest.raises(InvalidStatus):  # and been through its loop since
        connect(f"ws://127.0.0.1:{server.get_port()}", origin="http://evil.example")
    server.stop()
    assert "handshake" not in caplog.text


def test_a_port_that_is_taken_is_an_error_and_not_another_port(server: viser.ViserServer) -> None:
    with pytest.raises(ConfigError, match=rf"port {server.get_port()} is taken"):
        open_server(server.get_port(), "another page")


def test_no_browser_can_ask_for_a_public_address(server: viser.ViserServer) -> None:
    assert server.request_share_url() is None


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.5"])
def test_other_machines_are_let_in_only_with_a_token(host: str) -> None:
    with pytest.raises(ConfigError, match="token"):
        open_server(free_port(), "a page", host=host)
    for token in ("short", "a token with spaces in it", "a-token;of-two-cookies"):
        with pytest.raises(ConfigError, match="16 or more"):
            open_server(free_port(), "a page", host=host, token=token)
