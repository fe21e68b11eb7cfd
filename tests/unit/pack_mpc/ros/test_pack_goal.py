"""When the placement planner is asked, and what becomes of its answer."""

from types import SimpleNamespace
from unittest.mock import MagicMock, patch

import pytest
from pack_interfaces.msg import SceneState
from pack_interfaces.srv import PlanPlacement
from rclpy.task import Future

from pack_core.packing.goals import PackingMethod
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


@pytest.mark.parametrize(
    ("method", "is_sparing", "variant"),
    [
        (PackingMethod.PACK_IT_IN, False, PackingMethod.PACK_IT_IN.placement_variant),
        (PackingMethod.PACK_IT_IN, True, "algorithm_1"),
        (PackingMethod.UNINFORMED_POSE, True, PackingMethod.UNINFORMED_POSE.placement_variant),
    ],
)
def test_entries_are_rehearsed_unless_the_machine_is_too_busy(
    method: PackingMethod, is_sparing: bool, variant: str
) -> None:
    asked: list[PlanPlacement.Request] = []
    service = SimpleNamespace(
        service_is_ready=lambda: True, call_async=lambda sent: asked.append(sent) or Future()
    )
    client = PlacementClient(SimpleNamespace(create_client=lambda *contract: service))
    client.is_sparing = is_sparing
    task = SimpleNamespace(lean=0.0, tried=[], avoid=[], avoid_radius=0.02)
    session = SimpleNamespace(needs_placement=lambda scene: True, task=task, method=method)
    with patch("pack_mpc.ros.pack_goal.to_scene", return_value=SceneState()):
        client.serve(session, MagicMock())
    assert [request.variant for request in asked] == [variant]
