"""The result of a packing goal."""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.packing.exit_reason import PackingExitReason


@dataclass(frozen=True)
class PackingOutcome:
    """How a goal ended.

    Attributes:
        exit_reason: what ended it.
        success: whether FINE-TUNE was reached.
        message: the reason in words.
        execution_time: time from acceptance to the end [s].
        distance: from the held object to the packing pose at the end [m].
        force_mean: mean magnitude of the external force [N].
        force_peak: largest magnitude of the external force [N].
        placements: how many placements were tried.
    """

    exit_reason: PackingExitReason
    success: bool
    message: str
    execution_time: float
    distance: float
    force_mean: float
    force_peak: float
    placements: int
