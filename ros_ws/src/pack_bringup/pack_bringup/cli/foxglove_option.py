"""The option `--foxglove`, which serves a cell's live topics to Foxglove and Lichtblick."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Annotated

import typer

from pack_bringup.graph.executables import find_executable
from pack_core.errors import ConfigError

NODE = "foxglove"
FOXGLOVE_ADDRESS = "ws://127.0.0.1:8765"
INSTALL = ".venv/bin/uv pip install --python .venv/bin/python --require-hashes -r requirements/foxglove.txt"

Foxglove = Annotated[
    bool,
    typer.Option("--foxglove", help="Serve live topics to Foxglove, read only, to this machine only."),
]


def foxglove_command(cell: str) -> dict[str, list[str]]:
    """The command of the node that serves a cell's topics, by its name.

    Raises:
        ConfigError: the extra is not installed.
    """
    if find_spec("foxglove") is None:
        raise ConfigError(f"--foxglove needs foxglove-sdk, which is an extra; run: {INSTALL}")
    executable = str(find_executable("pack_bringup", "foxglove_node"))
    arguments = ["--ros-args", "-r", f"__node:={NODE}", "-p", f"cell:={cell}"]
    # It stands back behind the nodes: a late message to a viewer does no harm, a late setpoint does.
    return {NODE: ["nice", "-n", "5", executable, *arguments]}
