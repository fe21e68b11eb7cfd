"""When the placement planner is asked, and what becomes of its answer."""

from types import SimpleNamespace
from unittest.mock import MagicMock, patch

from pack_interfaces.srv import PlanPlacement
from rclpy.task import Future

from pack_mpc.ros.pack_goal import PlacementClient


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
