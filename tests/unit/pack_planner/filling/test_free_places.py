"""Where outlines have room beside others."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box, Cylinder, ObjectModel
from pack_core.rotations import Array
from pack_planner.filling.free_places import COARSE, FreePlaces, NoFitPolygons, Outline, PlacedOutline

CONTAINER = packing_cell().scene.container
GAP, WALL_GAP = 0.004, 0.006
BOX: ObjectModel = Box(name="box", shape="box", size=(0.09, 0.05, 0.1), mass=0.3)
CAN: ObjectModel = Cylinder(name="can", shape="cylinder", radius=0.04, height=0.1, mass=0.3)
PAIRS = [(BOX, 0.0, BOX), (BOX, np.pi / 2, CAN), (CAN, 0.0, CAN), (CAN, 0.0, BOX)]


def polygon(outline: Outline, xy: Array) -> shapely.Polygon:
    return shapely.Polygon(outline.corners + xy)


@pytest.mark.parametrize(("first", "yaw", "second"), PAIRS)
def test_an_outline_at_the_rim_of_its_free_places_keeps_its_distances(
    first: ObjectModel, yaw: float, second: ObjectModel
) -> None:
    one, other = PlacedOutline(Outline.of(first, yaw), np.array([0.45, 0.02])), Outline.of(second, 0.0)
    free = FreePlaces(NoFitPolygons(CONTAINER, GAP, WALL_GAP))
    free.put([one])
    corners = shapely.get_coordinates(free.of(other))
    assert len(corners)
    walls = shapely.box(*CONTAINER.lower, *CONTAINER.upper).exterior
    taken = polygon(one.outline, one.xy)
    distances = [polygon(other, xy).distance(taken) for xy in corners]
    # a corner of the rounded gap is cut by a polygon
    assert min(distances) > 0.9 * GAP - COARSE
    assert min(polygon(other, xy).distance(walls) for xy in corners) == pytest.approx(WALL_GAP, abs=1e-9)


def test_what_was_put_down_before_a_branch_counts_in_it_and_not_the_other_way() -> None:
    outline, no_fit = Outline.of(BOX, 0.0), NoFitPolygons(CONTAINER, GAP, WALL_GAP)
    start = FreePlaces(no_fit)
    start.put([PlacedOutline(outline, np.array([0.45, 0.0]))])
    before = start.of(outline).area
    branch = FreePlaces(no_fit, start)
    assert branch.of(outline).area == before
    branch.put([PlacedOutline(outline, np.array([0.57, 0.0]))])
    assert branch.of(outline).area < before
    assert start.of(outline).area == before


def test_what_is_wider_than_the_container_has_no_place() -> None:
    wide = Box(name="wide", shape="box", size=(0.28, 0.05, 0.1), mass=0.3)
    assert FreePlaces(NoFitPolygons(CONTAINER, GAP, WALL_GAP)).of(Outline.of(wide, 0.0)).is_empty
