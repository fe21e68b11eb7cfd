"""Viewers as processes beside a cell's nodes: the page in the browser, and the server for Foxglove."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from importlib.util import find_spec

from pack_bringup.graph.executables import find_executable
from pack_core.addresses import FOXGLOVE_PORT, LOOPBACK, PAGE_TOKEN_VARIABLE, page_address
from pack_core.errors import ConfigError
from pack_core.extras import install_command
from pack_core.namespace import ROOT

NODE = "live"


@dataclass(frozen=True)
class PageProcess:
    """The node `live` and what it serves.

    Attributes:
        cell: the cell that is shown.
        port: of the page.
        host: address to listen on; others than 127.0.0.1 need a token.
        token: what a browser must bring; empty: none.
        namespace: of the cell, as rcl writes it.
    """

    cell: str
    port: int
    host: str = LOOPBACK
    token: str = ""
    namespace: str = ROOT

    def commands(self) -> dict[str, list[str]]:
        """The command of the node, by its name."""
        command = [str(find_executable("pack_viewer", "live_node")), "--ros-args", "-r", f"__node:={NODE}"]
        command += ["-r", f"__ns:={self.namespace}"]
        for name, value in {"cell": self.cell, "port": self.port, "host": self.host}.items():
            command += ["-p", f"{name}:={json.dumps(value)}"]
        return {NODE: command}  # it does not stand back behind others (nice): STOP goes through it

    def environment(self) -> dict[str, str]:
        """What the node reads from its environment."""
        return {PAGE_TOKEN_VARIABLE: self.token} if self.token else {}

    @property
    def announcement(self) -> str:
        """Where the page is, and how to open it on a machine with a display."""
        return announcement(self.host, self.port, self.token)


def announcement(host: str, port: int, token: str = "") -> str:
    """A line that says where a page is, and how to open it on a machine with a display."""
    address = page_address(host, port, token)
    has_display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return f"page: {address}" + (f"  (xdg-open {address})" if has_display and sys.stdout.isatty() else "")


FOXGLOVE = "foxglove"
FOXGLOVE_ADDRESS = f"ws://{LOOPBACK}:{FOXGLOVE_PORT}"
INSTALL = install_command("foxglove", "--require-hashes")


def foxglove_command(cell: str, namespace: str = ROOT) -> dict[str, list[str]]:
    """The command of the node that serves a cell's topics, by its name.

    Raises:
        ConfigError: the extra is not installed.
    """
    if find_spec("foxglove") is None:
        raise ConfigError(f"--foxglove needs foxglove-sdk, which is an extra; run: {INSTALL}")
    executable = str(find_executable("pack_bringup", "foxglove_node"))
    arguments = ["--ros-args", "-r", f"__node:={FOXGLOVE}", "-r", f"__ns:={namespace}"]
    arguments += ["-p", f"cell:={cell}"]
    # It stands back behind the nodes: a late message to a viewer does no harm, a late setpoint does.
    return {FOXGLOVE: ["nice", "-n", "5", executable, *arguments]}
