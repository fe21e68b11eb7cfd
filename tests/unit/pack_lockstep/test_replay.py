"""What a service was asked and has answered, from the topic of its events."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_evaluation.bag import Bag, Recorded
from pack_lockstep.replay import RECEIVED, SENT, ComparisonRow, Replay, calls_in, exact_row, pictures_in

TOPIC = "/ask/_service_event"


def event(kind: int, client: int, number: int, text: str) -> Any:
    info = SimpleNamespace(event_type=kind, client_gid=np.array([client], np.uint8), sequence_number=number)
    return SimpleNamespace(
        info=info, request=[text] if kind == RECEIVED else [], response=[text] if kind == SENT else []
    )


def bag(*events: Any) -> Bag:
    messages = [Recorded(TOPIC, number, message) for number, message in enumerate(events)]
    return Bag(Path("bag"), tuple(messages), is_cut=False)


def test_an_answer_belongs_to_the_request_of_its_client_and_number() -> None:
    found = calls_in(
        bag(
            event(RECEIVED, 1, 1, "what"), event(RECEIVED, 2, 1, "where"), event(SENT, 2, 1, "here"),
            event(SENT, 1, 1, "that"),
        ),
        TOPIC,
    )  # fmt: skip
    assert [(call.request, call.answer, call.time_ns) for call in found] == [
        ("where", "here", 2),
        ("what", "that", 3),
    ]


def test_what_was_not_answered_or_not_asked_in_the_recording_is_left_out() -> None:
    found = calls_in(
        bag(
            event(SENT, 1, 1, "late"), event(RECEIVED, 1, 2, "what"), event(SENT, 1, 2, "that"),
            event(RECEIVED, 1, 3, "cut off"),
        ),
        TOPIC,
    )  # fmt: skip
    assert [call.answer for call in found] == ["that"]


def test_a_recording_without_an_answered_request_is_refused() -> None:
    with pytest.raises(BagError, match=r"no answered request on /ask/_service_event: was it recorded\?"):
        calls_in(bag(event(RECEIVED, 1, 1, "what")), TOPIC)


def test_a_recording_without_pictures_says_how_they_are_recorded() -> None:
    with pytest.raises(BagError, match=r"recorder\.pictures=true"):
        pictures_in(bag())


def test_a_replay_that_compared_nothing_does_not_agree() -> None:
    good = ComparisonRow("a", 10, 0.1, 0.2, 1.0)
    assert Replay("perception", {}, (good,)).agrees
    assert not Replay("perception", {}, ()).agrees
    assert not Replay("perception", {}, (good, ComparisonRow("b", 0, 0.0, 0.0, 1.0))).agrees
    assert not Replay("perception", {}, (good, ComparisonRow("b", 10, 0.5, 1.1, 1.0))).agrees


def test_an_answer_that_says_something_else_does_not_agree() -> None:
    assert exact_row("a", 0.0).agrees
    assert not exact_row("a", float("inf")).agrees
