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
from pack_mpc.ros.placement_client import PlacementClient, from_over


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
