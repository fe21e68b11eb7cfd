"""`pack stop` and `pack resume`: the arm of a running cell, by its driver."""

from __future__ import annotations

from typing import Annotated

import typer

from pack_bringup.cli.options import Domain, Namespace, Network, domain_of, prepare_network

app = typer.Typer()


@app.command()
def stop(
    reason: Annotated[str, typer.Argument(help="Why, for whoever reads how the goal ended.")] = "",
    domain: Domain = None,
    namespace: Namespace = "",
    network: Network = "",
) -> None:
    """Brake the arm of a running cell at once, and hold it.

    Gripper and pump keep what they hold. The goal in progress ends with the reason; the arm follows nothing
    until `pack resume`, a reset of the cell, or the next goal. This goes through the network and the driver:
    it does not take the place of an emergency stop.

    - `pack stop`
    - `pack stop "somebody is in the cell" --domain 7`
    """
    prepare_network(network)
    from pack_bringup.ros.arm_calls import stop_arm

    stop_arm(": ".join(filter(None, ("`pack stop`", reason))), domain_of(domain), namespace)
    typer.echo("the arm is stopped; `pack resume` lets it go on")


@app.command()
def resume(domain: Domain = None, namespace: Namespace = "", network: Network = "") -> None:
    """Let the arm of a running cell follow setpoints again after a stop; no goal goes on by itself.

    - `pack resume`
    - `pack resume --namespace left`
    """
    prepare_network(network)
    from pack_bringup.ros.arm_calls import resume_arm

    resume_arm(domain_of(domain), namespace)
    typer.echo("the arm follows setpoints again")
