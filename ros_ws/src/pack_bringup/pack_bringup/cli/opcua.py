"""`pack opcua`: a running cell as an OPC UA server."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.options import Domain, Namespace, Network, domain_of, prepare_network
from pack_bringup.graph.executables import find_executable
from pack_core.addresses import LOOPBACK
from pack_core.cells import CELLS, check_cell

app = typer.Typer()
NODE = "opcua"


@app.command()
def opcua(
    cell: Annotated[str, typer.Argument(help=f"The cell that is served: {', '.join(CELLS)}.")],
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen on.")] = 4840,
    host: Annotated[
        str,
        typer.Option(
            help="Address to listen on. Others than this machine's need --certificate, --key and --trusted: "
            "who connects can operate the cell."
        ),
    ] = LOOPBACK,
    certificate: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The server's certificate, DER or PEM.")
    ] = None,
    key: Annotated[Path | None, typer.Option(metavar="FILE", help="Its private key.")] = None,
    trusted: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Certificates of the clients that are let in, and of no others."),
    ] = None,
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
) -> None:
    """Serve a running cell to a PLC over OPC UA, until Ctrl-C (docs/operate/opcua.md).

    State, counters, the last goal and alarms can be read and subscribed to. Methods choose the next order,
    start, cancel, stop, resume and reset, and run shifts where the cell has them. The cell may come later and
    go earlier than the server.

    - `pack opcua palletizing`
    - `pack opcua blocks --domain 7 --port 4841`
    - `pack opcua palletizing --host 0.0.0.0 --certificate server.der --key server.key --trusted trusted`
    """
    from pack_bringup.opcua.server import ServerSettings, check_installed

    check_installed()
    ServerSettings(host, port, certificate, key, trusted).check()
    prepare_network(network)
    executable = str(find_executable("pack_bringup", "opcua_node"))
    command = [executable, "--ros-args", "-r", f"__node:={NODE}", "-r", f"__ns:={namespace}"]
    parameters: dict[str, str | int] = {"cell": check_cell(cell), "host": host, "port": port}
    for name, path in {"certificate": certificate, "key": key, "trusted": trusted}.items():
        if path is not None:
            parameters[name] = str(path.resolve())
    for name, value in parameters.items():
        command += ["-p", f"{name}:={json.dumps(value)}"]
    os.execve(executable, command, {**os.environ, "ROS_DOMAIN_ID": str(domain_of(domain))})
