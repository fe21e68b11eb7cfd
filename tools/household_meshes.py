"""Writes the meshes of config/object_sets/household.yaml, in millimetres: `python tools/household_meshes.py`.

Only the outer lengths are published; the forms between them are drawn by hand, and convex.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh

MESHES = Path(__file__).parents[1] / "config" / "object_sets" / "meshes"
SIDES = 20
"""Corners of a round section; even, so that the lengths along x and y are exact."""

Section = tuple[float, float, float]
"""Lengths along x and y of an elliptical section, and its height over the base [mm]."""


def stacked(sections: Sequence[Section]) -> trimesh.Trimesh:
    """The hull of elliptical sections one over the other."""
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    rings = [
        np.column_stack([0.5 * x * np.cos(angles), 0.5 * y * np.sin(angles), np.full(SIDES, z)])
        for x, y, z in sections
    ]
    return trimesh.PointCloud(np.concatenate(rings)).convex_hull


def round_body(profile: Sequence[tuple[float, float]]) -> trimesh.Trimesh:
    """A body of revolution through diameters at heights [mm]."""
    return stacked([(diameter, diameter, z) for diameter, z in profile])


def tin(x: float, y: float, z: float, radius: float) -> trimesh.Trimesh:
    """A tin with rounded upright edges [mm]."""
    angles = np.deg2rad(np.arange(0, 91, 15))
    arc = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    corner = arc + np.array([0.5 * x - radius, 0.5 * y - radius])
    outline = np.concatenate([corner * [sx, sy] for sx in (-1, 1) for sy in (-1, 1)])
    points = [np.insert(outline, 2, height, axis=1) for height in (0.0, z)]
    return trimesh.PointCloud(np.concatenate(points)).convex_hull


BODIES = {
    "mustard_bottle": stacked([
        (78, 44, 0), (85, 50, 6), (85, 50, 105), (74, 44, 125), (36, 34, 146), (32, 32, 158), (12, 12, 175),
    ]),
    "meat_can": tin(97, 50, 82, 13),
    "pear": round_body([
        (32, 0), (52, 6), (63, 18), (66.2, 32), (62, 46), (50, 62), (40, 78), (32, 90), (18, 98), (6, 100),
    ]),
    "apple": round_body([(28, 0), (53, 7), (69, 21), (75, 38), (71, 55), (56, 68), (34, 75)]),
    "bottle_100": round_body([(48, 0), (56, 4), (56, 66), (54, 78), (54, 105)]),
    "bottle_250": round_body([(60, 0), (70, 5), (70, 92), (56, 116), (54, 118), (54, 143)]),
}  # fmt: skip
"""Meshes by the names of their objects."""


def main() -> None:
    """Write every mesh."""
    MESHES.mkdir(parents=True, exist_ok=True)
    for name, body in BODIES.items():
        body.export(MESHES / f"{name}.obj", digits=3, include_normals=False)


if __name__ == "__main__":
    main()
