"""What the placement planner answers, read with care."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from hypothesis import given
from hypothesis import strategies as st

from pack_core.errors import MessageError
from pack_mpc.ros.placement_client import from_over


@given(st.floats(-math.pi, math.pi))
def test_a_unit_vector_is_taken(angle: float) -> None:
    np.testing.assert_allclose(
        from_over(Vector3(x=math.cos(angle), y=math.sin(angle))), [math.cos(angle), math.sin(angle)]
    )


def test_zero_is_no_side() -> None:
    np.testing.assert_array_equal(from_over(Vector3()), 0.0)


@pytest.mark.parametrize(
    ("over", "message"),
    [(Vector3(x=0.5), "length of 0.500; allowed: 1"), (Vector3(y=math.nan), "not finite")],
)
def test_anything_else_is_refused(over: Vector3, message: str) -> None:
    with pytest.raises(MessageError, match=message):
        from_over(over)
