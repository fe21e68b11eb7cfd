"""The scanners over the pallet and table B: a known scene in closed form, with the stated errors."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.motion.world import Obstacle
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.scanner import SCANNED
from pack_core.rotations import Pose, from_yaw
from pack_perception.scans.rays import Rays
from pack_sim.palletizing.place_scanner import PlaceScanner, PlaceScannerConfig
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig
from pack_sim.palletizing.true_cell import true_cell

CELL = palletizing_cell()
TABLE = "reorientation_table"
EXACT = PlaceScannerConfig(noise=0.0, lost=0.0)
BOX = BoxBody("box", (0.4, 0.3, 0.25), 5.0)
X_WB = Pose(
    np.array([CELL.reorientation_table.centre[0], 2.5, CELL.reorientation_table.height + 0.125]),
    from_yaw(0.3),
)


@pytest.fixture(scope="module")
def simulator() -> PalletSimulator:
    simulator = PalletSimulator(CELL, PalletSimulatorConfig())
    simulator.spawn(BOX, X_WB)
    return simulator


def scanner(config: PlaceScannerConfig, seed: int = 0) -> PlaceScanner:
    return PlaceScanner(CELL, config, seed)


def test_rays_meet_box_table_and_floor_where_they_should(simulator: PalletSimulator) -> None:
    rays = Rays.of(scanner(EXACT).scan(TABLE, simulator.still()), CELL.scanner_pose(TABLE))
    blocks = [*CELL.furniture, Obstacle("box", X_WB, np.array(BOX.size))]
    floor = -rays.p_W[2] / rays.directions_W[:, 2]
    expected = np.column_stack([rays.up_to(blocks), floor]).min(axis=1)
    # The simulator's table is a top on legs: rays past its edge that would meet its side go on to the floor.
    is_side = np.abs(rays.distances - expected) > 1e-6
    assert np.mean(is_side) < 0.05
    assert np.all(rays.distances[is_side] == pytest.approx(floor[is_side]))
    assert np.any(np.isclose(rays.ends_W[:, 2], X_WB.p[2] + 0.125))


@pytest.mark.parametrize("place", SCANNED)
def test_the_grid_covers_the_place_with_its_margin_at_the_stated_spacing(place: str) -> None:
    mount, where = getattr(CELL.scanners, place), getattr(CELL, place)
    rays, X_WS = CELL.scanner_rays(place), CELL.scanner_pose(place)
    depth = mount.height - where.middle[2]
    points = X_WS.apply(rays * (depth / rays[:, 2])[:, None])
    half = 0.5 * np.array(where.size) + mount.margin
    offsets = np.abs(points[:, :2] - where.middle[:2])
    assert np.all(offsets <= half + 1e-9)
    assert np.all(offsets.max(axis=0) > half - mount.spacing)
    assert len(rays) == pytest.approx(4.0 * half[0] * half[1] / mount.spacing**2, rel=0.01)


def test_errors_are_those_stated_and_repeat_with_the_seed(simulator: PalletSimulator) -> None:
    config, still = PlaceScannerConfig(noise=0.003, lost=0.02), simulator.still()
    exact, first, again, other = (
        scanner(c, seed).scan(TABLE, still).points
        for c, seed in ((EXACT, 0), (config, 0), (config, 0), (config, 1))
    )
    assert np.array_equal(first, again)
    assert len(first) == pytest.approx(0.98 * len(exact), rel=0.005)
    assert not np.array_equal(first[: len(other)], other[: len(first)])
    kept = PlaceScannerConfig(noise=0.003, lost=0.0)
    errors = np.linalg.norm(scanner(kept).scan(TABLE, still).points, axis=1) - np.linalg.norm(exact, axis=1)
    assert np.std(errors) == pytest.approx(0.003, rel=0.05)
    assert abs(np.mean(errors)) < 2e-4


def test_an_arm_over_the_pallet_is_seen_as_anything_else(simulator: PalletSimulator) -> None:
    rays = Rays.of(scanner(EXACT).scan("pallet", simulator.still()), CELL.scanner_pose("pallet"))
    assert np.max(rays.ends_W[:, 2]) > 1.5


def test_a_snapshot_stays_as_it_was_while_the_physics_goes_on(simulator: PalletSimulator) -> None:
    still = simulator.still()
    before = scanner(EXACT).scan(TABLE, still).points
    simulator.remove("box")
    simulator.step()
    assert np.array_equal(before, scanner(EXACT).scan(TABLE, still).points)
    simulator.spawn(BOX, X_WB)


def test_under_real_each_scanner_hangs_a_little_askew() -> None:
    cell = palletizing_cell("real")
    errors = cell.imperfections.scanners
    for place in SCANNED:
        known, true = cell.scanner_pose(place), true_cell(cell, 3).scanner_pose(place)
        assert np.linalg.norm(true.p - known.p) == pytest.approx(errors.position)
        assert true.q != pytest.approx(known.q, abs=1e-5)
