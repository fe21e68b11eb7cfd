"""What carries a box: shares and margins with known values."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.support import SupportConfig, support_of

BASE = PlacedBox("base", np.zeros(3), np.array([0.4, 0.4, 0.2]), 5.0)


def on_top(x: float, y: float = 0.0, size: tuple[float, float] = (0.4, 0.4)) -> PlacedBox:
    return PlacedBox("top", np.array([x, y, 0.2]), np.array([*size, 0.1]), 5.0)


def test_a_box_on_the_deck_is_carried_whole() -> None:
    support = support_of(BASE, [BASE])
    assert support.share == 1.0
    assert support.margin == pytest.approx(0.2)


@given(offset=st.floats(0.0, 0.399))
def test_share_and_margin_shrink_with_the_overhang(offset: float) -> None:
    support = support_of(on_top(offset), [BASE])
    assert support.share == pytest.approx(1.0 - offset / 0.4)
    assert support.margin == pytest.approx(min(0.2 - offset, 0.2), abs=1e-9)


def test_a_bridge_counts_only_what_lies_on_its_piers_but_is_safe_between_them() -> None:
    piers = [BASE, BASE.moved((0.8, 0.0, 0.0))]
    bridge = on_top(0.0, size=(1.2, 0.4))
    support = support_of(bridge, piers)
    assert support.share == pytest.approx(2 / 3)
    assert support.margin == pytest.approx(0.2)
    assert "66.7% of its base" in str(support.problem(SupportConfig()))


def test_a_floating_box_is_not_carried_at_all() -> None:
    support = support_of(on_top(0.0).moved((0.0, 0.0, 0.01)), [BASE])
    assert (support.share, support.margin) == (0.0, -np.inf)


def test_a_centre_of_mass_near_the_edge_is_told_in_millimetres() -> None:
    config = SupportConfig(min_share=0.0)
    assert "5 mm inside of what carries it" in str(support_of(on_top(0.195), [BASE]).problem(config))
    assert "25 mm outside of what carries it" in str(support_of(on_top(0.225), [BASE]).problem(config))
    assert support_of(on_top(0.15), [BASE]).problem(config) is None
