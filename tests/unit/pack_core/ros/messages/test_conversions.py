"""Stamps that are read from serialised messages."""

import pytest
from geometry_msgs.msg import WrenchStamped
from rclpy.serialization import serialize_message

from pack_core.errors import MessageError
from pack_core.ros.messages.conversions import stamp_in, to_stamp


@pytest.mark.parametrize("time", [0.0, 1.234567891, 4000.25])
def test_the_stamp_is_read_without_building_the_message(time: float) -> None:
    message = WrenchStamped()
    message.header.stamp = to_stamp(time)
    assert stamp_in(serialize_message(message)) == pytest.approx(time, abs=1e-9)


def test_a_message_that_is_too_short_to_have_a_stamp_is_refused() -> None:
    with pytest.raises(MessageError, match="3 bytes"):
        stamp_in(bytes(3))
