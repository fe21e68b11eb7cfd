"""Objects as markers: every shape is drawn in its size, where its body has it."""

import mujoco
import numpy as np
import pytest
from visualization_msgs.msg import Marker

from pack_core.packing.object_set import load_set
from pack_core.packing.scene_item import SceneItem
from pack_core.ros.messages.markers import shape_markers
from pack_core.rotations import Pose

SHAPES = {item.shape: item for item in load_set("household").objects}


@pytest.mark.parametrize("item", SHAPES.values(), ids=SHAPES.keys())
def test_the_marker_spans_the_bounding_box(item: SceneItem) -> None:
    spec = mujoco.MjSpec()
    spec.worldbody.add_body(name=item.name).add_geom(name=item.name, **item.geometry(spec))
    (marker,) = shape_markers(spec.compile(), 1, "objects")
    assert marker.header.frame_id == item.name
    q, p, scale = marker.pose.orientation, marker.pose.position, marker.scale
    X_BM = Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z]))
    if marker.type == Marker.TRIANGLE_LIST:
        corners = X_BM.apply(np.array([[c.x, c.y, c.z] for c in marker.points]))
        assert len(corners) % 3 == 0
    else:
        half = 0.5 * np.array([scale.x, scale.y, scale.z])
        corners = X_BM.apply(np.array([half, -half]))
    np.testing.assert_allclose(corners.max(axis=0), item.half_extents, atol=1e-6)
    np.testing.assert_allclose(corners.min(axis=0), -item.half_extents, atol=1e-6)
