"""A placement as markers: every shape has one, and the cheapest sample stands as it settled."""

from typing import get_args

import numpy as np
import pytest
from visualization_msgs.msg import Marker

from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box, ObjectModel
from pack_core.packing.scene import Scene
from pack_planner.placement.algorithm_1_planner import Algorithm1Planner
from pack_planner.placement.placement_config import PlacementConfig
from pack_planner.placement.ros.placement_markers import KINDS, SETTLED, _kind, to_visual_markers


def test_every_shape_has_a_marker() -> None:
    shapes = get_args(get_args(ObjectModel)[0])
    assert {shape.geom_type for shape in shapes} == set(KINDS)


def test_a_shape_without_a_marker_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(KINDS, Box.geom_type)
    with pytest.raises(NotImplementedError, match="no marker for shape mjGEOM_BOX"):
        _kind(Box(name="brick", shape="box", size=(0.1, 0.1, 0.1), mass=0.1))


def test_the_cheapest_sample_is_shown_as_a_settled_scene_with_its_cost(example: Scene, state_of) -> None:
    planner = Algorithm1Planner(example.description(), packing_cell(), PlacementConfig(samples=30))
    placement = planner.plan(state_of(example), np.random.default_rng(0))
    cheapest = placement.samples.spread(3)[0]
    markers = to_visual_markers(1.0, placement, example, cheapest).markers
    *shapes, label = [marker for marker in markers if marker.ns == SETTLED]
    assert [marker.id for marker in (*shapes, label)] == list(range(len(example.names) + 2))
    k = int(np.argmin(placement.samples.costs))
    for marker, pose in zip(shapes, placement.samples.scenes[k], strict=True):
        p = marker.pose.position
        np.testing.assert_allclose([p.x, p.y, p.z], pose[:3])
        assert 0.0 < marker.color.a < 1.0
    assert label.type == Marker.TEXT_VIEW_FACING
    assert label.text == f"cost {placement.samples.costs.min():.2f}"
