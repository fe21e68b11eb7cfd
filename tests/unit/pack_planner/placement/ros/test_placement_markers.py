"""A placement as markers: every shape has one, and the cheapest sample stands as it settled."""

import numpy as np
from visualization_msgs.msg import Marker

from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Capsule
from pack_core.packing.scene import Scene
from pack_planner.placement.least_disturbance_planner import LeastDisturbancePlanner
from pack_planner.placement.placement_evaluation import PlacementConfig
from pack_planner.placement.ros.placement_markers import SETTLED, to_visual_markers


def test_a_shape_that_rviz_does_not_know_is_drawn_as_triangles_of_its_size(example: Scene, state_of) -> None:
    tube = Capsule(name="tube", shape="capsule", radius=0.03, length=0.16, mass=0.3)
    scene = example.model_copy(update={"new_object": tube})
    planner = LeastDisturbancePlanner(scene.description(), packing_cell(), PlacementConfig(samples=30))
    placement = planner.plan(state_of(scene), np.random.default_rng(0))
    markers = to_visual_markers(1.0, placement, scene, placement.samples.spread(3)[0]).markers
    (drawn,) = [marker for marker in markers if marker.ns == "placement"]
    assert drawn.type == Marker.TRIANGLE_LIST
    corners = np.array([[p.x, p.y, p.z] for p in drawn.points])
    assert len(corners) % 3 == 0
    np.testing.assert_allclose(np.ptp(corners, axis=0), 2 * tube.half_extents, atol=1e-9)


def test_the_cheapest_sample_is_shown_as_a_settled_scene_with_its_cost(example: Scene, state_of) -> None:
    planner = LeastDisturbancePlanner(example.description(), packing_cell(), PlacementConfig(samples=30))
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
