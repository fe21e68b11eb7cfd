"""Curves of the tool: what they say of their derivatives is what their poses do."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from pack_core.motion.moves import Line
from pack_core.rotations import Array, Pose, angle_between, exp, from_matrix, multiply
from pack_motion.reference.curve import curve_segments, hermite
from pack_motion.reference.trajectory import MoveRefused

START = Pose(np.array([0.5, 0.0, 0.3]), exp(np.array([0.3, -0.2, 0.5])))
UP, ASIDE = np.array([0.0, 0.0, 0.2]), np.array([0.1, -0.4, 0.0])


def path(turn: Array, share: float) -> list[Line]:
    """Up and aside round a corner; a share of the turn is made on the way up."""
    X_1 = Pose(START.p + UP, multiply(exp(share * turn), START.q))
    X_2 = Pose(X_1.p + ASIDE, multiply(exp(turn), START.q))
    return [Line(X_1, exit_speed=0.3, blend=0.08), Line(X_2)]


def even() -> float:
    return float(np.linalg.norm(UP) / (np.linalg.norm(UP) + np.linalg.norm(ASIDE)))


@pytest.mark.parametrize("turn", [np.zeros(3), np.array([0.2, 0.1, -0.9])])
def test_a_rounded_corner_leads_from_line_to_line_with_the_derivatives_it_states(turn: Array) -> None:
    lines = path(turn, even())
    run = curve_segments(START, lines, 0)
    assert len(run) == 3
    end, h = START, 1e-6
    for segment in run:
        s = np.linspace(0.0, segment.curve.length, 21)
        points = segment.curve.at(s)
        np.testing.assert_allclose(points.p[0], end.p, atol=1e-9)
        assert angle_between(from_matrix(points.R[0]), end.q) < 1e-7
        end = Pose(points.p[-1], from_matrix(points.R[-1]))
        inner = s[1:-1]
        before, after = segment.curve.at(inner - h), segment.curve.at(inner + h)
        np.testing.assert_allclose((after.p - before.p) / (2 * h), points.dp[1:-1], atol=1e-5)
        np.testing.assert_allclose((after.dp - before.dp) / (2 * h), points.ddp[1:-1], atol=1e-2)
        np.testing.assert_allclose((after.turn - before.turn) / (2 * h), points.dturn[1:-1], atol=1e-4)
        spin = np.einsum("tij,tkj->tik", (after.R - before.R) / (2 * h), points.R[1:-1])
        rates = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
        np.testing.assert_allclose(rates, points.turn[1:-1], atol=1e-6)
    np.testing.assert_allclose(end.p, lines[-1].X_WT.p, atol=1e-9)
    assert angle_between(end.q, lines[-1].X_WT.q) < 1e-7


def test_neither_direction_nor_turn_jumps_where_a_corner_meets_its_lines() -> None:
    first, corner, second = curve_segments(START, path(np.array([0.0, 0.0, 0.9]), even()), 0)
    for one, other in ((first, corner), (corner, second)):
        end, start = one.curve.at(np.array([one.curve.length])), other.curve.at(np.zeros(1))
        np.testing.assert_allclose(end.dp, start.dp, atol=1e-9)
        np.testing.assert_allclose(end.ddp, start.ddp, atol=1e-6)
        np.testing.assert_allclose(end.turn, start.turn, atol=1e-9)


@pytest.mark.parametrize(
    ("turn", "share"), [(np.array([0.0, 0.0, 0.9]), 0.0), (np.array([0.0, 0.0, 2.9]), even())]
)
def test_no_corner_is_rounded_where_the_tool_turns_unevenly_or_quickly(turn: Array, share: float) -> None:
    with pytest.raises(MoveRefused, match="set blend to 0"):
        curve_segments(START, path(turn, share), 0)


@pytest.mark.parametrize("aside", [0.0, 1e-4, 0.02])
def test_the_way_back_is_not_rounded_into_but_begins_with_a_stop(aside: float) -> None:
    there, back = Pose(START.p + UP, START.q), Pose(START.p + np.array([aside, 0.0, 0.0]), START.q)
    run = curve_segments(START, [Line(there, exit_speed=0.3, blend=0.08), Line(back)], 0)
    assert len(run) == 2
    assert run[0].limits.exit_speed == 0.0


def test_the_cubic_through_values_and_slopes_is_that_of_scipy() -> None:
    rng = np.random.default_rng(0)
    xs = np.cumsum(rng.uniform(0.1, 1.0, 9))
    ys, slopes = rng.normal(size=(2, 9))
    x = np.concatenate([xs, rng.uniform(xs[0], xs[-1], 50)])
    expected = CubicHermiteSpline(xs, ys, slopes)(x)
    np.testing.assert_allclose(hermite(x, xs, ys, slopes), expected, rtol=1e-12, atol=1e-12)
