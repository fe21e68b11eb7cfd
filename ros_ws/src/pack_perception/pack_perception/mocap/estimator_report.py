"""What the estimator did with a measurement."""

from __future__ import annotations

from dataclasses import dataclass, field

from pack_perception.mocap.rigid_body_fit import FitRefusal


@dataclass(frozen=True)
class Advance:
    """What happened on the way to a joint sample.

    Attributes:
        is_restart: everything was forgotten, because time or the arm jumped.
        diverged: objects that were put back to where they were.
    """

    is_restart: bool = False
    diverged: tuple[str, ...] = ()


@dataclass(frozen=True)
class Correction:
    """What a frame brought.

    Attributes:
        seen: objects whose pose was corrected.
        partly: those of them that showed too few markers for a pose without the help of physics.
        refused: objects whose markers could not be used, and why.
        is_unused: the frame is older than the history or ahead of the joints, and changed nothing.
    """

    seen: tuple[str, ...] = ()
    partly: tuple[str, ...] = ()
    refused: dict[str, FitRefusal] = field(default_factory=dict)
    is_unused: bool = False
