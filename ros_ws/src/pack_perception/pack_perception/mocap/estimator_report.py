"""Reports of what the estimator did with a measurement."""

from __future__ import annotations

from dataclasses import dataclass, field

from pack_perception.mocap.rigid_body_fit import FitRefusal


@dataclass(frozen=True)
class Advance:
    """What happened while physics advanced to a joint sample.

    Attributes:
        is_restart: whether the estimate was reset, because time or the arm jumped.
        diverged: objects whose simulated motion diverged and that were put back to their last pose.
    """

    is_restart: bool = False
    diverged: tuple[str, ...] = ()


@dataclass(frozen=True)
class Correction:
    """What a marker frame changed.

    Attributes:
        seen: objects whose pose was corrected.
        partly: those of them whose markers alone were too few for a pose, so that physics helped.
        refused: objects whose markers could not be used, and why.
        mismatched: objects some of whose markers were left out, as they do not match the others.
        is_unused: whether the frame changed nothing, being older than the history or ahead of the joints.
    """

    seen: tuple[str, ...] = ()
    partly: tuple[str, ...] = ()
    refused: dict[str, FitRefusal] = field(default_factory=dict)
    mismatched: tuple[str, ...] = ()
    is_unused: bool = False
