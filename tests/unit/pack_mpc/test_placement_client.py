"""What the placement planner answers, read with care."""

import math
from types import SimpleNamespace
from unittest.mock import MagicMock, patch

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from hypothesis import given
from hypothesis import strategies as st
from pack_interfaces.srv import PlanPlacement
from rclpy.task import Future

from pack_core.errors import MessageError
from pack_mpc.ros.placement_client import PlacementClient, from_over, to_way


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
def test_the_way_in_is_taken_with_its_offset_if_it_has_one(back: float | None) -> None:
    offset = [] if back is None else [back]
    way = to_way(PlanPlacement.Response(over=Vector3(y=1.0), lean=0.4, back=offset))
    np.testing.assert_array_equal(way.over, [0.0, 1.0])
    assert (way.lean, way.back) == (0.4, back)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"lean": 2.0}, "lean is 2.0; allowed: radians"),
        ({"lean": -0.1}, "lean is -0.1"),
        ({"lean": math.inf}, "lean is not finite"),
        ({"back": [math.nan]}, "back is not finite"),
        ({"back": [-0.01]}, "back is -0.01; allowed: metres from 0 on"),
    ],
)
def test_a_way_in_that_makes_no_sense_is_refused(fields: dict[str, object], message: str) -> None:
    with pytest.raises(MessageError, match=message):
        to_way(PlanPlacement.Response(**fields))


def test_a_placement_is_pending_from_its_request_to_its_answer() -> None:
    answer, session = Future(), MagicMock()
    service = SimpleNamespace(service_is_ready=lambda: True, call_async=lambda request: answer)
    client = PlacementClient(SimpleNamespace(create_client=lambda *contract: service))
    assert not client.is_pending
    with patch.object(client, "_request"):
        client.serve(session, MagicMock())
    assert client.is_pending
    answer.set_result(PlanPlacement.Response(status=PlanPlacement.Response.SUCCESS + 1))
    assert not client.is_pending
    client.serve(session, MagicMock())
    session.task.refuse.assert_called_once()
