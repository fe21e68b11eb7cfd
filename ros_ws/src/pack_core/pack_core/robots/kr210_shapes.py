"""The shapes by which the KR 210 is drawn, and the capsules by which it collides, link by link."""

from __future__ import annotations

import mujoco

Capsules = tuple[tuple[float, tuple[float, ...]], ...]
"""Radius and both end points of each capsule [m]."""
Shapes = tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...]
"""Kind, place, size and colour of each: a `rod` is a cylinder from point to point with a radius, a
`round` a capsule likewise, a `block` a box at a point with half sizes."""

ORANGE = (0.95, 0.38, 0.05, 1.0)
DARK = (0.13, 0.13, 0.14, 1.0)
GREY = (0.42, 0.43, 0.45, 1.0)
STEEL = (0.62, 0.64, 0.66, 1.0)

BASE_SHAPES: Shapes = (
    ("block", (0, 0, 0.03), (0.40, 0.40, 0.03), DARK),
    ("rod", (0, 0, 0.06, 0, 0, 0.24), (0.34,), DARK),
    ("block", (-0.30, 0, 0.14), (0.14, 0.20, 0.10), DARK),
)
PEDESTAL_SHAPES: Shapes = (
    ("block", (0, 0, -0.5), (0.36, 0.36, 0.48), GREY),
    ("block", (0, 0, -0.01), (0.44, 0.44, 0.01), STEEL),
    ("block", (0, 0, -0.99), (0.44, 0.44, 0.01), STEEL),
)
"""For a pedestal of unit height with its top at z = 0; scaled to the height it has."""

LINK_SHAPES: tuple[Shapes, ...] = (
    (  # rotating column, in frame A1: z points down
        ("rod", (0, 0, -0.24, 0, 0, -0.38), (0.36,), ORANGE),
        ("round", (-0.05, 0, -0.42, 0.24, 0, -0.58), (0.21,), ORANGE),
        ("rod", (0.33, -0.10, -0.645, 0.33, 0.17, -0.645), (0.25,), ORANGE),
        ("rod", (0.33, 0.17, -0.645, 0.33, 0.40, -0.645), (0.12,), DARK),
        ("rod", (-0.22, 0.12, -0.40, -0.22, 0.12, -0.72), (0.10,), DARK),
    ),
    (  # upper arm, in frame A2: x along the arm, z to the side of the motor
        ("rod", (0, 0, -0.32, 0, 0, -0.10), (0.22,), ORANGE),
        ("block", (0.575, 0, -0.21), (0.52, 0.125, 0.085), ORANGE),
        ("block", (0.575, 0, -0.125), (0.36, 0.07, 0.01), DARK),
        ("rod", (1.15, 0, -0.30, 1.15, 0, -0.10), (0.18,), ORANGE),
    ),
    (  # elbow, in frame A3: y along the forearm
        ("rod", (0, 0, -0.10, 0, 0, 0.16), (0.175,), ORANGE),
        ("block", (0.10, -0.02, 0.03), (0.13, 0.21, 0.14), ORANGE),
        ("rod", (0.115, 0.15, 0, 0.115, 0.30, 0), (0.135,), DARK),
        ("rod", (0.19, -0.20, 0.08, 0.19, -0.44, 0.08), (0.065,), DARK),
        ("rod", (0.19, -0.20, -0.06, 0.19, -0.44, -0.06), (0.065,), DARK),
        ("rod", (0.04, -0.20, 0.02, 0.04, -0.42, 0.02), (0.060,), DARK),
    ),
    (  # forearm tube, in frame A4: -z along the forearm
        ("round", (0, 0, -0.34, 0, 0, -0.62), (0.125,), ORANGE),
        ("round", (0, 0, -0.60, 0, 0, -0.98), (0.100,), ORANGE),
        ("block", (0, 0.085, -1.13), (0.075, 0.025, 0.16), ORANGE),
        ("block", (0, -0.085, -1.13), (0.075, 0.025, 0.16), ORANGE),
        ("rod", (0, 0, -0.30, 0, 0, -0.34), (0.145,), STEEL),
    ),
    (  # wrist, in frame A5
        ("rod", (0, 0, -0.115, 0, 0, 0.115), (0.085,), DARK),
        ("round", (0, -0.01, 0, 0, -0.08, 0), (0.075,), DARK),
    ),
    (  # mounting flange, in frame A6: -z out of the arm
        ("rod", (0, 0, -0.08, 0, 0, -0.185), (0.085,), DARK),
        ("rod", (0, 0, -0.185, 0, 0, -0.215), (0.100,), STEEL),
    ),
)  # fmt: skip
LINK_CAPSULES: tuple[Capsules, ...] = (
    ((0.30, (-0.05, 0, -0.25, 0.20, 0, -0.58)),),
    ((0.18, (0.05, 0, -0.20, 1.15, 0, -0.20)),),
    ((0.20, (0.08, -0.22, 0.02, 0.08, 0.10, 0.02)),),
    ((0.13, (0, 0, -0.20, 0, 0, -0.62)), (0.11, (0, 0, -0.62, 0, 0, -1.16))),
    ((0.11, (0, 0, -0.03, 0, 0, 0.03)),),
    ((0.09, (0, 0, -0.09, 0, 0, -0.12)),),
)


def draw_base(body: mujoco.MjsBody, height: float) -> None:
    """Draw the base, and a pedestal of the given height [m] under it."""
    _draw(body, BASE_SHAPES)
    if height <= 0.0:
        return
    for kind, (x, y, z), (a, b, c), colour in PEDESTAL_SHAPES:
        _draw(body, ((kind, (x, y, z * height), (a, b, c * height), colour),))


def draw_link(body: mujoco.MjsBody, index: int) -> None:
    """Draw link `index`, counted from 0."""
    _draw(body, LINK_SHAPES[index])


def _draw(body: mujoco.MjsBody, shapes: Shapes) -> None:
    kinds = {"rod": mujoco.mjtGeom.mjGEOM_CYLINDER, "round": mujoco.mjtGeom.mjGEOM_CAPSULE}
    for kind, place, size, colour in shapes:
        where = {"pos": place} if kind == "block" else {"fromto": place}
        body.add_geom(
            type=kinds.get(kind, mujoco.mjtGeom.mjGEOM_BOX), size=(*size, 0, 0)[:3], rgba=colour, mass=0,
            contype=0, conaffinity=0, **where,
        )  # fmt: skip
