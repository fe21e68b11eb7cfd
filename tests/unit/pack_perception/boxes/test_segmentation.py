"""Drawn pictures: what is box and what is table."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.camera import Picture
from pack_perception.boxes.segmentation import SegmentationConfig, segment

CONFIG = SegmentationConfig(margin_x=0.1, margin_y=0.05)
BOX = (slice(60, 140), slice(80, 200))


def scene(box: int, table: int) -> Picture:
    picture = np.full((200, 300, 3), table, dtype=np.uint8)
    picture[BOX] = box
    return picture


@pytest.mark.parametrize(("box", "table", "is_dark"), [(180, 50, False), (40, 200, True)])
def test_boxes_are_found_lighter_or_darker_than_the_table(box: int, table: int, is_dark: bool) -> None:
    found = segment(scene(box, table), CONFIG)
    assert found.is_dark is is_dark
    assert found.corner == (30, 10)
    (outline,) = found.contours
    np.testing.assert_allclose(outline.min(axis=0) + found.corner, (80, 60), atol=1)
    np.testing.assert_allclose(outline.max(axis=0) + found.corner, (199, 139), atol=1)
    assert found.contrast == pytest.approx(abs(box - table), abs=6)


def test_specks_vanish_and_a_stripe_of_print_is_closed() -> None:
    picture = scene(180, 50)
    picture[20:23, 250:253] = 255
    picture[98:101, 80:200] = 40
    (outline,) = segment(picture, CONFIG).contours
    assert np.ptp(outline[:, 1]) == pytest.approx(79, abs=2)


def test_strictness_leaves_out_what_is_just_above_the_threshold() -> None:
    picture = scene(200, 40)
    picture[60:140, 200:230] = 126
    loose, strict = (
        segment(picture, CONFIG.model_copy(update={"strictness": value})).contours[0] for value in (0.0, 60.0)
    )
    assert np.ptp(strict[:, 0]) < np.ptp(loose[:, 0])


def test_what_lies_outside_the_region_of_interest_is_not_looked_at() -> None:
    picture = scene(180, 50)
    picture[:, :25] = 255
    assert len(segment(picture, CONFIG).contours) == 1


def test_an_even_picture_has_no_contrast() -> None:
    assert segment(np.full((200, 300, 3), 90, dtype=np.uint8), CONFIG).contrast == 0.0
