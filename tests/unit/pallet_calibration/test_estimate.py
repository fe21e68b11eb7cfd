"""The least-squares estimate of a cell, from measurements that are made up from known parameters."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.cell import palletizing_cell
from pack_core.robots.joint_properties import GearCompensation
from pack_core.rotations import Array, Pose, exp, multiply
from pallet_calibration.conclusion import calibratable, conclude, model_of
from pallet_calibration.estimate import CORNER, CalibrationFit, estimate
from pallet_calibration.measurements import BoardView, FeltContact
from pallet_calibration.model import CellModel, sag_at
from pallet_calibration.parameters import (
    GEARS,
    PLACE,
    prior_sigmas,
    start,
)
from pallet_calibration.prediction import predict
from pallet_calibration.procedure import Measurements
from pallet_calibration.rig import CalibrationFailed
from pallet_calibration.touch import Touch, rotated_down

REAL = palletizing_cell("real")
OLD = calibratable(REAL).assumed.model_copy(
    update={"stiffness": (3.8e6, 4.1e6, 2.4e6, 6.1e5, 5.7e5, 3.3e5), "backlash_deg": 0.008}
)
"""The gears as an earlier calibration may have found them."""
X_TB = Pose([0.0, 0.23, 0.009], rotated_down(-np.pi / 2))
"""The board held by its handle."""


def truth(rng: np.random.Generator) -> Array:
    """Parameters about as far from the nominal ones as the preset has them."""
    x = start() + 0.3 * prior_sigmas() * rng.uniform(-1.0, 1.0, len(start()))
    x[13:19] *= 0.3  # the board lies in the gripper to some millimetres
    return x


def reached(model: CellModel, X_WT: Pose) -> Array | None:
    arm = arm_kinematics()
    return arm.inverse.follow(X_WT, arm.home, arm.inverse.branch(arm.home))


def views(model: CellModel, x: Array, rng: np.random.Generator) -> list[BoardView]:
    ids = np.arange(0, 90, 5)
    found = []
    while len(found) < 15:
        p = np.array([-2.4, 2.2, 1.0]) + rng.uniform(-1.0, 1.0, 3) * [0.3, 0.3, 0.25]
        q_WT = multiply(exp(0.3 * rng.normal(size=3)), rotated_down(rng.uniform(1.6, 3.0)))
        if (q := reached(model, Pose(p, q_WT))) is None:
            continue
        view = BoardView(q, ids, np.zeros((len(ids), 2)))
        (exact,) = model.pixels(x, [(view, model.sag(q, loaded=True).links(x))])
        found.append(BoardView(q, ids, exact + CORNER * rng.normal(size=exact.shape)))
    return found


def contact(model: CellModel, x: Array, what: str, axis: int, at: float, p: Array, n: Array) -> FeltContact:
    """A touch of a true surface: the reported joints at which the corner lies on it."""
    p_TC, q_WT = np.array([0.055, 0.055, 0.0]), rotated_down(0.7)
    touched = Touch(what, axis, at, n, p_TC, np.zeros(1), np.zeros((1, 6)), np.zeros((1, 6)))
    bears = np.full(6, 0.5) * 100.0
    c = FeltContact(touched, np.zeros(6), 1e-5, 1.0, bears, np.zeros(0), np.zeros(0))
    along = 0.0
    for _ in range(6):  # the gap depends on the way nearly linearly
        q = reached(model, Pose(p + along * n, q_WT))
        assert q is not None
        gap = model.gap(x, c, sag_at(model, replace(c, q=q)).links(x))
        along -= gap * float(n[axis])
    return replace(c, q=q, gives=model.give(x, c))


def contacts(model: CellModel, x: Array) -> list[FeltContact]:
    down, found = np.array([0.0, 0.0, -1.0]), []
    for name in PLACE:
        place = getattr(REAL, name)
        for dx, dy in ((0.0, 0.0), (0.25, 0.2), (-0.25, 0.2), (-0.25, -0.2), (0.25, -0.2)):
            p = place.middle + np.array([dx, dy, 0.0])
            found.append(contact(model, x, name, 2, place.middle[2], p, down))
    (x_0, y_0), (l, w), z = REAL.pallet.corner, REAL.pallet.size, REAL.pallet.deck_height
    for share in (0.04, 0.2):
        p = np.array([x_0, y_0 + share * w, z])
        found.append(contact(model, x, "pallet", 0, x_0, p, np.array([1.0, 0.0, 0.0])))
    for share in (0.4, 0.95):
        p = np.array([x_0 + share * l, y_0 + w, z])
        found.append(contact(model, x, "pallet", 1, y_0 + w, p, np.array([0.0, -1.0, 0.0])))
    return found


@cache
def made_up(seed: int, driver: GearCompensation | None = None) -> tuple[Measurements, Array]:
    rng = np.random.default_rng(seed)
    measured = Measurements(X_TB=X_TB)
    model, x = model_of(REAL, measured, driver), truth(rng)
    measured.views, measured.contacts = views(model, x, rng), contacts(model, x)
    return measured, x


@cache
def fitted(seed: int, driver: GearCompensation | None = None) -> CalibrationFit:
    measured, _ = made_up(seed, driver)
    return estimate(model_of(REAL, measured, driver), measured)


@pytest.mark.parametrize("driver", [None, OLD])
def test_what_was_made_up_is_found_within_its_uncertainty(driver: GearCompensation | None) -> None:
    """Also where the driver compensated the gears by an earlier calibration while it was measured."""
    found, (_, x) = fitted(0, driver), made_up(0, driver)
    off = np.abs(found.x - x) / np.sqrt(np.diag(found.covariance))
    assert off.max() < 4.5
    assert np.sqrt(np.mean(off**2)) < 1.6
    assert all(line.ratio < 1.5 for line in found.residuals())


def test_where_the_links_are_does_not_depend_on_what_the_driver_compensates() -> None:
    """It reports other angles for the same motors."""
    measured, x = made_up(0)
    plain, other = (model_of(REAL, measured, driver) for driver in (None, OLD))
    for view in measured.views:
        sag = plain.sag(view.q, loaded=True)
        lead = other.sag(view.q, loaded=True).lead
        assert np.abs(lead - sag.lead).max() > 1e-5
        reported = view.q + sag.lead - lead
        np.testing.assert_allclose(other.sag(reported, loaded=True).links(x), sag.links(x), atol=2e-7)


def test_what_was_touched_and_seen_is_known_much_better_than_before() -> None:
    sigma = np.sqrt(np.diag(fitted(0).covariance))
    assert np.all(sigma[PLACE["pallet"]][:3] < 0.0005)
    assert np.all(sigma[:2] < 0.0005)  # the camera's place, x and y
    assert np.all(sigma[GEARS] <= prior_sigmas()[GEARS] + 1e-9)


def test_a_good_calibration_predicts_a_small_placing_error() -> None:
    measured, _ = made_up(0)
    predicted = predict(model_of(REAL, measured), fitted(0), np.random.default_rng(0))
    assert 0.05 < predicted.mean < 0.7
    assert predicted.mean < predicted.p95 < 3 * predicted.mean


@pytest.mark.parametrize("what", ["a table that moved", "a board that slipped"])
def test_measurements_that_contradict_each_other_are_refused(what: str) -> None:
    measured, _ = made_up(0)
    spoilt = Measurements(list(measured.contacts), list(measured.views), measured.X_TB)
    if what == "a table that moved":  # by 2 mm, while it was touched
        model = model_of(REAL, measured)
        k = next(i for i, c in enumerate(spoilt.contacts) if c.touch.axis == 2)
        old = spoilt.contacts[k]
        X_WT = arm_kinematics().chain.forward(old.q)
        q = reached(model, Pose(X_WT.p + np.array([0.0, 0.0, 0.002]), X_WT.q))
        assert q is not None
        spoilt.contacts[k] = replace(old, q=q)
    else:  # from one half of the pictures to the other, by 3 pixels
        half = len(spoilt.views) // 2
        spoilt.views[half:] = [replace(view, pixels=view.pixels + 3.0) for view in spoilt.views[half:]]
    with pytest.raises(CalibrationFailed, match="not to be trusted"):
        conclude(REAL, spoilt, 300.0)
