"""What the conveyor of a shift tells, in messages."""

import pytest
from pack_interfaces.msg import InfeedState as InfeedStateMsg

from pack_core.errors import MessageError
from pack_core.palletizing.infeed import InfeedState
from pack_core.ros.messages.palletizing import from_infeed, to_infeed


@pytest.mark.parametrize("box", ["", "S-12", "9 / b (2)"])
def test_a_state_comes_through_as_it_was_sent(box) -> None:
    state = InfeedState(1.5, 3, box, "tea")
    assert from_infeed(to_infeed(state)) == state


@pytest.mark.parametrize("box", ["<b>", " ", "a" * 65, "a\n"])
def test_a_name_by_which_no_box_can_be_tracked_is_refused(box) -> None:
    with pytest.raises(MessageError, match=r"^box is .*; allowed: up to 64 of letters, digits"):
        from_infeed(InfeedStateMsg(box=box))
