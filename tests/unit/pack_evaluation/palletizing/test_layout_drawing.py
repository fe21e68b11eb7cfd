"""Pictures of a layout, as `pack layout` writes them."""

from pathlib import Path

from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_evaluation.palletizing.drawings import write_pictures
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner


def test_pictures_are_written_for_the_layout_and_every_insertion(tmp_path: Path) -> None:
    order = load_order(config_path("orders", "order_09.json"))
    plan = LayoutPlanner(LayoutConfig()).plan(order)
    paths = write_pictures(order, plan, tmp_path)
    assert len(paths) == 1 + len(plan.boxes)
    assert all(path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 5000 for path in paths)
