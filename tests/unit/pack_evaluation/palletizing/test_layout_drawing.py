"""Pictures of a layout, as `pack layout` writes them."""

from itertools import product
from pathlib import Path

import numpy as np

from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.paths import config_path
from pack_evaluation.palletizing.drawings import draw_order, from_back_to_front, write_pictures
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner


def test_pictures_are_written_for_the_layout_and_every_insertion(tmp_path: Path) -> None:
    order = load_order(config_path("orders", "order_09.json"))
    plan = LayoutPlanner(LayoutConfig()).plan(order)
    paths = write_pictures(order, plan, tmp_path)
    assert len(paths) == 1 + len(plan.boxes)
    assert all(path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 5000 for path in paths)


def test_in_space_the_deck_is_drawn_first_and_what_is_nearer_to_the_eye_later() -> None:
    size = np.array([0.2, 0.2, 0.2])
    corners = [0.25 * np.array(corner) for corner in product(range(2), repeat=3)]
    boxes = [PlacedBox(str(k), corner, size, 1.0) for k, corner in enumerate(corners)]
    drawn = from_back_to_front(boxes[::-1])
    rank = {box.id: k for k, box in enumerate(drawn)}
    for one, other in product(boxes, repeat=2):
        nearer = (other.lower - one.lower) * np.array([1.0, -1.0, 1.0])  # the eye is at +x, -y and +z
        if one is not other and np.all(nearer >= 0.0):
            assert rank[one.id] < rank[other.id]
    figure = draw_order(load_order(config_path("orders", "order_16.json")), [])
    orders = [item.get_zorder() for item in figure.axes[0].collections]
    assert orders == sorted(orders)
    assert len(set(orders)) == len(orders)
