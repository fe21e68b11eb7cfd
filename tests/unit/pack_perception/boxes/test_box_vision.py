"""Rendered boxes are found to tenths of a millimetre or refused with the reason; never wrong yet believed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.rotations import Pose, from_yaw, rotate, yaw_of
from unit.pack_perception.boxes.spawns import TABLE, Dims, Spawn, Stage, errors, spawns

LIMIT_MM, LIMIT_DEG = 0.5, 0.1


def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def standing(dims: Dims, x: float = 0.0, y: float = 0.0, yaw_deg: float = 0.0, name: str = "box") -> Spawn:
    """A box off the middle of the table."""
    p_WB = [TABLE.centre[0] + x, TABLE.centre[1] + y, TABLE.height + 0.5 * dims[2]]
    return Spawn(name, dims, Pose(np.array(p_WB), from_yaw(np.deg2rad(yaw_deg))))


def test_no_light_makes_a_wrong_pose_believed(lit: Stage) -> None:
    for spawn in spawns(2, rng()):
        detection = lit.look(spawn, rng()).detection
        if detection.status is DetectionStatus.DETECTED:
            off_mm, off_deg = errors(detection, spawn)
            assert off_mm < LIMIT_MM
            assert off_deg < LIMIT_DEG
        else:
            assert detection.X_WB is None
            assert detection.reason


@pytest.mark.parametrize(
    "spawn",
    [
        standing((0.6, 0.4, 0.25), 0.1, -0.1, 10.0),
        standing((0.3, 0.115, 0.115), -0.1, 0.1, -10.0),
        standing((0.25, 0.15, 0.15), 0.1, 0.1, 0.0),
    ],
    ids=["large", "narrow", "sides in view"],
)
def test_boxes_of_every_size_are_found_in_the_cells_light(nominal: Stage, spawn: Spawn) -> None:
    detection = nominal.look(spawn, rng()).detection
    assert detection.status is DetectionStatus.DETECTED, detection.reason
    off_mm, off_deg = errors(detection, spawn)
    assert (
        off_mm < 0.2
    )  # the renderer takes four samples a pixel of 1 mm: an edge along them is known to 0.13 mm
    assert off_deg < 0.03
    assert (detection.time, detection.box_id) == (1.0, "box")


def test_the_tool_is_sent_to_the_middle_of_the_top_face_pad_down(nominal: Stage) -> None:
    spawn = standing((0.4, 0.3, 0.2), 0.05, 0.02, 7.0)
    detection = nominal.look(spawn, rng()).detection
    assert detection.X_WT is not None
    np.testing.assert_allclose(detection.X_WT.p, spawn.X_WB.p + np.array([0, 0, 0.1]), atol=2e-4)
    np.testing.assert_allclose(rotate(detection.X_WT.q, [0, 0, 1]), [0, 0, -1], atol=1e-9)
    np.testing.assert_allclose(
        rotate(detection.X_WT.q, [0, 1, 0]), rotate(spawn.X_WB.q, [0, 1, 0]), atol=1e-3
    )


@pytest.mark.parametrize(("dims", "yaw_deg", "expected"), [
    ((0.3, 0.3, 0.2), 50.0, -40.0), ((0.3, 0.3, 0.2), -30.0, -30.0), ((0.3, 0.2, 0.2), 80.0, 80.0),
])  # fmt: skip
def test_the_smallest_equivalent_turn_is_told(
    nominal: Stage, dims: Dims, yaw_deg: float, expected: float
) -> None:
    detection = nominal.look(standing(dims, yaw_deg=yaw_deg), rng()).detection
    assert detection.X_WB is not None, detection.reason
    assert np.rad2deg(yaw_of(detection.X_WB.q)) == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize(
    "expected",
    [(0.41, 0.3, 0.2), (0.4, 0.296, 0.2), (0.4, 0.2, 0.3), (0.3, 0.3, 0.2), (0.4, 0.3, 0.18)],
    ids=["longer", "narrower", "standing", "square", "flatter"],
)
def test_a_box_of_another_size_is_refused_with_both_sizes(nominal: Stage, expected: Dims) -> None:
    detection = nominal.look(standing((0.4, 0.3, 0.2), 0.03, 0.02, 4.0), rng(), expected).detection
    assert detection.status is DetectionStatus.WRONG_SIZE
    assert f"box 'box' has {expected[0] * 1e3:.1f} x {expected[1] * 1e3:.1f} mm" in detection.reason
    assert detection.size[0] == pytest.approx(0.4, abs=0.02)  # as if at the expected height


def look_at(stage: Stage, things: list[Spawn]) -> BoxDetection:
    """Look for the first of these boxes."""
    box = (
        ExpectedBox(things[0].id, things[0].dims, 0.0) if things else ExpectedBox("box", (0.4, 0.3, 0.2), 0.0)
    )
    return stage.vision.detect(stage.picture(things, rng()), stage.camera, box, TABLE.height, 1.0).detection


def test_an_empty_table_has_no_box(nominal: Stage) -> None:
    assert look_at(nominal, []).status is DetectionStatus.NOT_FOUND


def test_two_boxes_are_doubtful(nominal: Stage) -> None:
    detection = look_at(
        nominal, [standing((0.3, 0.2, 0.2), -0.2), standing((0.3, 0.2, 0.2), 0.2, name="other")]
    )
    assert detection.status is DetectionStatus.DOUBTFUL
    assert "2 things stand out" in detection.reason


def test_a_second_box_that_touches_it_is_refused(nominal: Stage) -> None:
    detection = look_at(
        nominal, [standing((0.3, 0.2, 0.2), -0.15), standing((0.3, 0.2, 0.2), 0.15, name="other")]
    )
    assert detection.status is not DetectionStatus.DETECTED


def test_a_box_that_is_cut_off_is_doubtful(nominal: Stage) -> None:
    detection = look_at(nominal, [standing((0.4, 0.3, 0.2), 0.45)])
    assert detection.status is DetectionStatus.DOUBTFUL
    assert "reaches the border" in detection.reason


def test_something_on_top_of_the_box_is_refused(nominal: Stage) -> None:
    box = standing((0.4, 0.3, 0.2))
    lid = Spawn("lid", (0.3, 0.2, 0.05), Pose(box.X_WB.p + np.array([0.12, 0.1, 0.125]), box.X_WB.q))
    assert look_at(nominal, [box, lid]).status is not DetectionStatus.DETECTED


def test_debug_images_show_frame_region_mask_and_overlay(nominal: Stage, tmp_path: Path) -> None:
    sighting = nominal.look(standing((0.4, 0.3, 0.2)), rng())
    images = sighting.images
    assert images.roi.shape == images.overlay.shape == (*images.mask.shape, 3)
    assert not np.array_equal(images.roi, images.overlay)
    assert np.count_nonzero(images.mask) * 1e-6 == pytest.approx(0.4 * 0.3 * (3.0 / 2.8) ** 2 * 0.88, rel=0.1)
    paths = images.write(tmp_path / "debug", "a box")
    assert [path.name for path in paths] == [
        f"a box_{name}.png" for name in ("frame", "roi", "mask", "overlay")
    ]
    assert all(path.stat().st_size > 100 for path in paths)
