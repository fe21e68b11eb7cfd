"""Which stages of a goal the packing page ticks, and what of a goal stays for the next one."""

import json
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from pack_core.packing import topics
from pack_viewer.event_log import EventLog
from pack_viewer.news import News
from pack_viewer.packing.packing_page import PackingPage
from pack_viewer.web_server import open_server
from unit.pack_evaluation.packing.messages import make


@pytest.fixture
def page() -> Iterator[PackingPage]:
    server = open_server(0, "stages")
    made = PackingPage(server, EventLog())
    for fill in made.tabs().values():
        fill()
    yield made
    server.stop()


def run(page: PackingPage, start: float, stages: tuple[str, ...]) -> None:
    """A goal goes through stages, one a second."""
    for k, stage in enumerate(stages):
        status = make("pack_interfaces/msg/MpcStatus", stage=stage, elapsed=float(k))
        status.header.stamp.sec = int(start) + k
        page.update(News({topics.MPC_STATUS: [status]}, start + k))
    page.show()


def end(page: PackingPage, reason: str, time: float) -> None:
    text = json.dumps({"exit_reason": reason, "message": reason})
    page.update(News({topics.RESULT: [SimpleNamespace(data=text)]}, time))
    page.show()


def ticked(page: PackingPage) -> list[str]:
    shown = page._stage_chips.content
    return [name for name in ("LOOK", "PRE-PACK", "INSERT", "FINE-TUNE") if f"✓ {name}" in shown]


def test_stages_and_plots_of_a_goal_that_ended_do_not_stay_in_the_next(page: PackingPage) -> None:
    run(page, 10.0, ("PRE_PACK", "INSERT", "FINE_TUNE"))
    end(page, "placed", 13.0)
    assert ticked(page) == ["PRE-PACK", "INSERT", "FINE-TUNE"]
    run(page, 20.0, ("PRE_PACK", "INSERT"))
    assert ticked(page) == ["PRE-PACK"]
    assert page._iteration_plots[0].points[:, 0].min() >= 20.0


def test_a_stage_that_was_stopped_is_not_ticked(page: PackingPage) -> None:
    run(page, 10.0, ("PRE_PACK", "INSERT"))
    end(page, "canceled", 12.0)
    assert ticked(page) == ["PRE-PACK"]


def iterate(page: PackingPage, period: float, count: int) -> None:
    for k in range(count):
        status = make("pack_interfaces/msg/MpcStatus", stage="INSERT", elapsed=period * k)
        status.header.stamp.nanosec = round(1e9 * period * k)
        page.update(News({topics.MPC_STATUS: [status]}, period * k))


def test_the_page_draws_few_frames_while_iterations_are_late(page: PackingPage) -> None:
    iterate(page, 0.04, 5)
    assert not page.is_sparing
    iterate(page, 0.1, 5)
    assert page.is_sparing
    page.forget()
    assert not page.is_sparing
