"""Asks the driver of a running cell's arm to stop, and to go on."""

from __future__ import annotations

from typing import Any

from pack_interfaces.srv import StopArm
from std_srvs.srv import Trigger

from pack_bringup.graph.running import place, running_cells
from pack_bringup.ros.status_listener import StatusListener
from pack_core.errors import PackError
from pack_core.namespace import ROOT, below
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.contracts.shared import RESUME_ARM, STOP_ARM

PATIENCE = 5.0
"""Longest time until the driver is found, and until it answers [s of wall clock]."""


def stop_arm(reason: str, domain: int, namespace: str = ROOT) -> None:
    """Have the arm braked at once and held; raises PackError where nobody does it."""
    _call(STOP_ARM, StopArm.Request(reason=reason), domain, namespace)


def resume_arm(domain: int, namespace: str = ROOT) -> None:
    """Have the arm follow setpoints again; raises PackError where nobody does it, or the driver refuses."""
    answer = _call(RESUME_ARM, Trigger.Request(), domain, namespace)
    if not answer.success:
        raise PackError(f"the arm stays stopped: {answer.message}")


def _call(service: Contract, request: Any, domain: int, namespace: str) -> Any:
    with StatusListener(domain, namespace) as listener:
        client = listener.node.create_client(service.type, below(namespace, service.name))
        if not listener.spin_until(client.service_is_ready, PATIENCE):
            others = "; ".join(f"in {place(*where)} {what}" for where, what in running_cells().items())
            raise PackError(
                f"nobody serves {client.srv_name} in {place(domain, namespace)}: no driver is up there"
                + (f"; {others} (--domain, --namespace)" if others else "")
            )
        answer = client.call_async(request)
        if not listener.spin_until(answer.done, PATIENCE):
            raise PackError(f"{client.srv_name} has not answered for {PATIENCE:.0f} s")
        return answer.result()
