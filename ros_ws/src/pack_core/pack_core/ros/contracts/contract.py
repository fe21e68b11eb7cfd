"""A line of a wiring table, and the qualities of service that lines share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from action_msgs.msg import GoalStatusArray
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_action_status_default,
)


class Kind(Enum):
    """What a contract is."""

    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"


@dataclass(frozen=True)
class Contract:
    """One line of a wiring table; a service is recorded by the topic of its events (`events_of`)."""

    name: str
    type: type[Any]
    sources: tuple[str, ...]
    targets: tuple[str, ...]
    what: str
    kind: Kind = Kind.TOPIC
    qos: QoSProfile | None = None
    rate: str = ""
    recorded: bool = False

    @property
    def is_latched(self) -> bool:
        """Whether a late listener to the topic is sent its newest message."""
        assert self.qos is not None, f"{self.name} is no topic"
        return bool(self.qos.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def contracts_in(names: Mapping[str, object]) -> tuple[Contract, ...]:
    """The contracts among a module's names, in the order in which they stand there."""
    return tuple(value for value in list(names.values()) if isinstance(value, Contract))


def events_of(service: Contract) -> Contract:
    """The topic on which the node that offers a service tells its requests and answers.

    The middleware does this: service introspection, at the name where `ros2 service echo` looks for it.
    """
    return Contract(
        f"{service.name}/_service_event", service.type.Event, service.targets, ("recorder",),
        f"requests and answers of {service.name}", qos=EVENTS, rate="each request and answer", recorded=True,
    )  # fmt: skip


def goal_states_of(action: Contract, target: str) -> Contract:
    """The topic on which the node that pursues an action's goals tells their states, for who listens to it.

    The middleware does this, as for every action (design.ros2.org, actions).
    """
    return Contract(
        f"{action.name}/_action/status", GoalStatusArray, action.targets, (target,),
        f"states of the goals of {action.name}", qos=qos_profile_action_status_default,
    )  # fmt: skip


def hz(rate: float) -> str:
    """A rate of simulated time [Hz] as the tables write it."""
    return f"{rate:.3g} Hz"


def _reliable(depth: int) -> QoSProfile:
    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=depth, reliability=ReliabilityPolicy.RELIABLE)


def _latched() -> QoSProfile:
    return QoSProfile(
        depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
    )


STREAM = _reliable(50)
"""What comes at a rate: a reader may be 50 messages late, 0.1 s of the fastest."""
LATEST = _reliable(1)
"""What counts only while it is the newest."""
EVENTS = _reliable(100)
"""What must not be lost, and may come in bursts."""
LATCHED = _latched()
"""What changes seldom: whoever joins late gets the last one."""
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
"""For a listener that a lost message must not hold up: a reliable one waits until it is sent again."""
