"""The way in, through the answer of the placement planner."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from hypothesis import given
from hypothesis import strategies as st
from pack_interfaces.srv import PlanPlacement

from pack_core.errors import MessageError
from pack_core.packing.entry import WayIn
from pack_core.ros.messages.packing import fill_way, from_over, from_way


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


@pytest.mark.parametrize("back", [None, 0.05])
def test_a_way_in_comes_through_an_answer_as_it_was(back: float | None) -> None:
    response = PlanPlacement.Response()
    fill_way(response, WayIn(np.array([0.0, 1.0]), 0.4, back))
    way = from_way(response)
    np.testing.assert_array_equal(way.over, [0.0, 1.0])
    assert (way.lean, way.back) == (0.4, back)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"lean": 2.0}, "lean is 2.0; allowed: radians"),
        ({"lean": -0.1}, "lean is -0.1"),
        ({"lean": math.inf}, "lean is inf"),
        ({"lean": math.nan}, "lean is nan"),
        ({"back": [math.nan]}, "back is not finite"),
        ({"back": [-0.01]}, "back is -0.01; allowed: metres from 0 on"),
    ],
)
def test_a_way_in_that_makes_no_sense_is_refused(fields: dict[str, object], message: str) -> None:
    with pytest.raises(MessageError, match=message):
        from_way(PlanPlacement.Response(**fields))
