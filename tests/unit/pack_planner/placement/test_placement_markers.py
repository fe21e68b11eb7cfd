"""The chosen placement as a marker: every shape has one."""

from typing import get_args

import pytest

from pack_core.packing.objects import Box, ObjectModel
from pack_planner.placement.ros.placement_markers import KINDS, _kind


def test_every_shape_has_a_marker() -> None:
    shapes = get_args(get_args(ObjectModel)[0])
    assert {shape.geom_type for shape in shapes} == set(KINDS)


def test_a_shape_without_a_marker_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(KINDS, Box.geom_type)
    with pytest.raises(NotImplementedError, match="no marker for shape mjGEOM_BOX"):
        _kind(Box(name="brick", shape="box", size=(0.1, 0.1, 0.1), mass=0.1))
