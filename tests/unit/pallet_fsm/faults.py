"""What shall go wrong in the cell without physics."""

from dataclasses import dataclass


@dataclass
class Faults:
    """What shall go wrong.

    Attributes:
        unseen: pictures in which there still will be no box.
        turned: pictures after which the box still will be turned by somebody.
        wrong_size: pictures in which it still will have another size.
        slips: grips that still will fail at table A.
        table_slips: the same at table B.
        stuck: moves that still will stop on their way.
        stuck_at_box: moves that still will stop on their last line down to a box on table A.
        refused: moves that still will be refused.
        refused_carrying: the same, counting only those with a box in the hand.
        held: how often the driver still will hold the arm.
        lost_ways: moves that still will find no way on after that.
        lost_at: label of the segment at whose end the hand loses its box; empty: it does not.
        reason: that the gripper gives then.
        mute: parts of the cell that take commands and answer none.
    """

    unseen: int = 0
    turned: int = 0
    wrong_size: int = 0
    slips: int = 0
    table_slips: int = 0
    stuck: int = 0
    stuck_at_box: int = 0
    refused: int = 0
    refused_carrying: int = 0
    held: int = 0
    lost_ways: int = 0
    lost_at: str = ""
    reason: str = ""
    mute: frozenset[str] = frozenset()
