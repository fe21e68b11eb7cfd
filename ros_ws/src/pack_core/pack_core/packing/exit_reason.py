"""The ways in which a packing goal can end (section IV-C), for live runs and recordings alike."""

from __future__ import annotations

from enum import Enum


class PackingExitReason(Enum):
    """How a goal ended; `UNFINISHED` where a recording stops before its end."""

    PLACED = "placed"
    TIMEOUT = "timeout"
    DETACHED = "detached"
    FORCE = "force"
    NO_PLACEMENT = "no_placement"
    CANCELED = "canceled"
    FAULT = "fault"
    UNFINISHED = "unfinished"
