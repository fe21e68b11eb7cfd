"""The blocks page: the steps of a plan, also once nothing is left of it."""

from collections.abc import Iterator
from typing import Any

import pytest

from pack_core.blocks import topics
from pack_core.motion import topics as motion
from pack_viewer.blocks.blocks_page import BlocksPage
from pack_viewer.event_log import EventLog
from pack_viewer.news import News
from pack_viewer.web_server import open_server
from unit.pack_evaluation.packing.messages import make


@pytest.fixture
def page() -> Iterator[BlocksPage]:
    server = open_server(0, "steps")
    made = BlocksPage(server, EventLog())
    for fill in made.tabs().values():
        fill()
    yield made
    server.stop()


def tell(page: BlocksPage, phase: str, actions: int, done: int, plans: int) -> None:
    plan = [make("pack_interfaces/msg/BlockAction") for _ in range(actions)]
    status: Any = make("pack_interfaces/msg/RearrangeStatus", phase=phase, plan=plan, done=done, plans=plans)
    page.update(News({topics.STATUS: [status]}, 1.0))
    page.show()


def test_the_steps_of_a_plan_that_was_carried_out_are_ticked(page: BlocksPage) -> None:
    tell(page, "PICK", actions=2, done=1, plans=1)
    assert page._plan.content.count("✓") == 1
    tell(page, "DONE", actions=0, done=0, plans=2)
    assert page._plan.content.count("✓") == 2
    assert "no plan" not in page._plan.content


def test_a_new_goal_has_no_steps_yet(page: BlocksPage) -> None:
    tell(page, "PICK", actions=2, done=1, plans=1)
    tell(page, "PERCEIVE", actions=0, done=0, plans=0)
    assert "there is no plan yet" in page._plan.content


def move(page: BlocksPage, at: float) -> None:
    motion_status: Any = make("pack_interfaces/msg/MotionStatus", path_error=0.001)
    page.update(News({motion.MOTION_STATUS: [motion_status]}, at))


def test_the_curves_of_a_goal_stay_when_it_has_ended(page: BlocksPage) -> None:
    move(page, 0.5)
    tell(page, "PICK", actions=2, done=1, plans=1)
    for at in (1.5, 2.0):
        move(page, at)
    tell(page, "DONE", actions=0, done=0, plans=2)
    move(page, 99.0)
    assert page._error.points[:, 0].tolist() == [0.5, 1.0, 1.5, 2.0]
