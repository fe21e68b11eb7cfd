"""The files for RViz and Foxglove name only topics, fields and frames that there are."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import pytest
import yaml

from pack_core.cells import CELLS
from pack_core.paths import config_path
from pack_core.ros.contracts.contract import Contract, Kind
from pack_core.ros.contracts.table import goal_actions, wiring_of
from pack_core.ros.messages.conversions import WORLD

TRANSIENT = "Transient Local"
TOPIC_KEYS = ("topic", "topicPath", "topicToRender", "imageTopic", "value")
"""Keys of a Foxglove layout whose text is a topic, or a path into its messages, if it begins with a slash."""
FRAME_KEYS = ("frameId", "followTf", "Fixed Frame", "Reference Frame", "Target Frame")


@pytest.fixture(params=CELLS)
def cell(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def topics_of(cell: str) -> dict[str, Contract]:
    return {contract.name: contract for contract in wiring_of(cell) if contract.kind is Kind.TOPIC}


def foxglove(cell: str) -> dict[str, Any]:
    layout: dict[str, Any] = json.loads(config_path("foxglove", f"{cell}.json").read_text())
    return layout


def rviz(cell: str) -> dict[str, Any]:
    config: dict[str, Any] = yaml.safe_load(config_path("rviz", f"{cell}.rviz").read_text())
    return config


def entries(tree: Any) -> Iterator[tuple[str, Any]]:
    """Every key and its value, however deep."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield key, value
            yield from entries(value)
    elif isinstance(tree, list):
        for item in tree:
            yield from entries(item)


def has_field(message: Any, path: list[str]) -> bool:
    """Whether a message has a field at the end of a path such as `header`, `stamp`."""
    if not path:
        return True
    kind = message.get_fields_and_field_types().get(path[0])
    if kind is None:
        return False
    if "/" not in kind:
        return len(path) == 1
    package, name = kind.split("/")
    return has_field(getattr(import_module(f"{package}.msg"), name), path[1:])


def test_every_path_of_the_layout_is_a_field_of_a_topic_of_the_cell(cell: str) -> None:
    topics, layout = topics_of(cell), foxglove(cell)
    paths = [v for k, v in entries(layout) if k in TOPIC_KEYS and isinstance(v, str) and v.startswith("/")]
    paths += [name for k, v in entries(layout) if k == "topics" for name in v]
    assert len(paths) > 8
    for path in paths:
        name, *fields = path.split(".")
        assert name in topics, path
        assert has_field(topics[name].type, fields), path


def test_every_panel_of_the_layout_is_configured_and_shown(cell: str) -> None:
    layout = foxglove(cell)

    def panels(tree: Any) -> set[str]:
        return {tree} if isinstance(tree, str) else panels(tree["first"]) | panels(tree["second"])

    assert panels(layout["layout"]) == layout["configById"].keys()


def test_every_topic_of_rviz_is_one_of_the_cell_and_is_latched_where_it_is(cell: str) -> None:
    topics = topics_of(cell)
    given = [v for k, v in entries(rviz(cell)) if k in ("Topic", "Description Topic")]
    assert len(given) >= 4
    for topic in given:
        contract = topics[topic["Value"]]
        assert contract.qos is not None
        is_latched = contract.qos.durability.name == "TRANSIENT_LOCAL"
        assert (topic["Durability Policy"] == TRANSIENT) is is_latched, contract.name


def test_frames_are_those_of_the_world(cell: str) -> None:
    frames = {v for k, v in (*entries(rviz(cell)), *entries(foxglove(cell))) if k in FRAME_KEYS}
    assert frames == {WORLD}


@pytest.mark.parametrize("cell", CELLS)
def test_the_page_sends_the_goals_of_a_cell_to_one_node(cell: str) -> None:
    assert len({server for action in goal_actions(cell) for server in action.targets}) == 1
