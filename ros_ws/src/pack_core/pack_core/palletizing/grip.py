"""What a surface gripper says about its grip."""

from __future__ import annotations

from dataclasses import dataclass

ASKED = "asked to open"
"""Reason of a gripper that was told to let go, and of one that never held anything."""


@dataclass(frozen=True)
class GripLoad:
    """Load on the pad.

    Attributes:
        coaxial: pull along the pad's axis [N]; negative where the box is pressed against it.
        shear: across the axis [N].
        moment: about the middle of the pad's face, all axes together [N m].
    """

    coaxial: float = 0.0
    shear: float = 0.0
    moment: float = 0.0

    def worst(self, other: GripLoad) -> GripLoad:
        """The larger of both in every respect."""
        return GripLoad(
            max(self.coaxial, other.coaxial), max(self.shear, other.shear), max(self.moment, other.moment)
        )


@dataclass(frozen=True)
class GripState:
    """The gripper now.

    Attributes:
        held: name of the box that it holds; empty when none.
        is_closing: whether it is still trying to take hold.
        load: on the pad in the last step.
        peak: worst loads since it took hold, kept after it let go.
        reason: why it does not hold; empty while it holds or tries.
    """

    held: str = ""
    is_closing: bool = False
    load: GripLoad = GripLoad()
    peak: GripLoad = GripLoad()
    reason: str = ""

    @property
    def is_closed(self) -> bool:
        """Whether it holds a box."""
        return bool(self.held)

    @property
    def is_open(self) -> bool:
        """Whether it neither holds a box nor tries to."""
        return not self.held and not self.is_closing
