"""Marker frames as arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.packing.cell import packing_cell
from pack_core.packing.markers import MarkerFrame
from pack_perception.mocap.sighting import MarkerTable

SCENE = packing_cell().scene
FRAME = MarkerFrame(
    0.0, ("sugar_box", "soup_can"), np.array([0, 1, 1]), np.array([5, 0, 2]),
    np.arange(9.0).reshape(3, 3), np.array([2, 3, 4]),
)  # fmt: skip


def test_markers_are_sorted_by_name_not_by_order() -> None:
    table = MarkerTable(SCENE)
    p_WM, visible = table.sort(FRAME)
    sugar, soup = table.names.index("sugar_box"), table.names.index("soup_can")
    assert np.array_equal(p_WM[sugar, 5], [0.0, 1.0, 2.0])
    assert np.array_equal(p_WM[soup, [0, 2]], [[3.0, 4.0, 5.0], [6.0, 7.0, 8.0]])
    assert visible.sum() == 3


def test_an_empty_frame_shows_nothing() -> None:
    none = np.zeros(0, dtype=int)
    _, visible = MarkerTable(SCENE).sort(MarkerFrame(0.0, (), none, none, np.zeros((0, 3)), none))
    assert not visible.any()


def test_an_object_that_the_scene_does_not_have_is_refused() -> None:
    with pytest.raises(MessageError, match=r"teapot.*the scene has.*soup_can"):
        MarkerTable(SCENE).sort(replace(FRAME, objects=("teapot", "soup_can")))


def test_a_marker_that_objects_do_not_have_is_refused() -> None:
    with pytest.raises(MessageError, match="marker 6; objects have 0 to 5"):
        MarkerTable(SCENE).sort(replace(FRAME, marker_index=np.array([6, 0, 2])))
