"""When the placement planner is asked, and what becomes of its answer."""

from collections.abc import Callable
from types import SimpleNamespace
from unittest.mock import MagicMock, patch

import pytest
from pack_interfaces.msg import SceneState
from pack_interfaces.srv import PlanPlacement
from rclpy.task import Future

from pack_core.packing.goals import PackingMethod
from pack_core.ros.awaited_answer import PATIENCE
from pack_mpc.ros.pack_goal import PlacementClient


def client_of(call: Callable[[PlanPlacement.Request], Future], *, is_ready: bool = True) -> PlacementClient:
    service = SimpleNamespace(service_is_ready=lambda: is_ready, call_async=call, srv_name="/plan_placement")
    node = SimpleNamespace(create_client=lambda *contract: service, get_logger=MagicMock)
    return PlacementClient(node)


def test_a_planner_whose_answer_was_lost_is_asked_again() -> None:
    asked, session, now = list[Future](), MagicMock(), [0.0]
    client = client_of(lambda request: asked.append(Future()) or asked[-1])
    with (
        patch.object(client, "_request"),
        patch("pack_mpc.ros.pack_goal.time", SimpleNamespace(monotonic=lambda: now[0])),
    ):
        client.serve(session, MagicMock())
        for now[0] in (PATIENCE[0] - 0.1, PATIENCE[0] + 0.1):
            client.serve(session, MagicMock())
    assert len(asked) == 2
    assert client.is_pending


def test_a_planner_that_is_not_up_is_named_and_not_asked() -> None:
    client = client_of(MagicMock(side_effect=AssertionError), is_ready=False)
    client.serve(MagicMock(), MagicMock())
    assert not client.is_pending
    assert "nobody serves /plan_placement" in str(client._log.warning.call_args)


def test_a_placement_is_pending_from_its_request_to_its_answer() -> None:
    answer, session = Future(), MagicMock()
    client = client_of(lambda request: answer)
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
    client = client_of(lambda sent: asked.append(sent) or Future())
    client.is_sparing = is_sparing
    task = SimpleNamespace(lean=0.0, answers=0, avoid=[], avoid_radius=0.02)
    session = SimpleNamespace(needs_placement=lambda scene: True, task=task, method=method)
    with patch("pack_mpc.ros.pack_goal.to_scene", return_value=SceneState()):
        client.serve(session, MagicMock())
    assert [request.variant for request in asked] == [variant]
