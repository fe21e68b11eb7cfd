"""Boxes of the orders on the picking table, as the overhead camera sees them in good and bad light."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.camera import Picture, PinholeCamera
from pack_core.palletizing.boxes import BoxBody, BoxDetection, ExpectedBox
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.view import CellView
from pack_core.paths import config_path
from pack_core.rotations import Array, Pose, from_yaw, yaw_of
from pack_perception.boxes.box_vision import BoxVision, IllustratedDetection, VisionConfig
from pack_perception.boxes.segmentation import SegmentationConfig

Dims = tuple[float, float, float]
CELL = palletizing_cell()
TABLE = CELL.picking_table


@dataclass(frozen=True)
class Light:
    """How the table and the boxes look.

    Attributes:
        name: of the condition.
        table: brightness of the table's top, 0 to 1; None as it is.
        tint: multiplies the cardboard's colour.
        lamp: multiplies what the lamps and the camera's own light give.
        slope: of the lamp that casts shadows, sideways for every metre down; None as it is.
        noise: of the sensor, standard deviation of 255.
        shadows: whether the lamp casts them.
    """

    name: str
    table: float | None = None
    tint: float = 1.0
    lamp: float = 1.0
    slope: tuple[float, float] | None = None
    noise: float = 0.0
    shadows: bool = True


NOMINAL = Light("nominal")
LIGHTS = (
    NOMINAL,
    Light("noisy", noise=5.0),
    Light("dim", lamp=0.35, noise=3.0),
    Light("grey table", table=0.35, noise=2.0),
    Light("long shadows", table=0.4, slope=(1.2, 0.8), noise=2.0),
    Light("light table, dark boxes", table=0.9, tint=0.35, noise=2.0),
    Light("low contrast", table=0.74, noise=2.0),
    Light("light table, dark boxes, no shadows", table=0.9, tint=0.35, noise=2.0, shadows=False),
    Light("light table, dark boxes, long shadows", table=0.8, tint=0.45, slope=(1.2, -0.8), noise=2.0),
)


class LitView(CellView):
    """The cell's pictures in another light."""

    def __init__(self, light: Light, width: int, height: int) -> None:
        super().__init__(CELL, width, height, shadows=light.shadows)
        self._light, model = light, self._model
        if light.table is not None:
            model.geom("picking_table").rgba[:3] = light.table
        model.light_diffuse[:] *= light.lamp
        model.vis.headlight.ambient[:] *= light.lamp
        model.vis.headlight.diffuse[:] *= light.lamp
        if light.slope is not None:
            casts = np.flatnonzero(model.light_castshadow)
            direction = np.array([*light.slope, -1.0])
            model.light_dir[casts] = direction / np.linalg.norm(direction)

    def _add_box(self, scene: mujoco.MjvScene, box: BoxBody, X_WB: Pose) -> None:
        super()._add_box(scene, box, X_WB)
        scene.geoms[scene.ngeom - 1].rgba[:3] = self._light.tint


@dataclass(frozen=True)
class Spawn:
    """A box on the table."""

    id: str
    dims: Dims
    X_WB: Pose


def order_boxes() -> list[tuple[str, Dims]]:
    """Names and sizes of the boxes of all orders."""
    paths = sorted(config_path("orders").glob("*.json"))
    return [(item.id, item.dims) for path in paths for item in load_order(path).boxes]


def spawns(n: int, rng: np.random.Generator) -> Iterator[Spawn]:
    """Random boxes of the orders, offset and turned as far as the cell has it."""
    boxes = order_boxes()
    for _ in range(n):
        name, dims = boxes[rng.integers(len(boxes))]
        offset = rng.uniform(-1.0, 1.0, 2) * CELL.spawn.offset
        yaw = np.deg2rad(rng.uniform(-1.0, 1.0) * CELL.spawn.yaw_deg)
        p_WB = np.array([*(np.array(TABLE.centre) + offset), TABLE.height + 0.5 * dims[2]])
        yield Spawn(name, dims, Pose(p_WB, from_yaw(yaw)))


class Stage:
    """Takes pictures in one light, of the full camera's region of interest alone, and looks at them."""

    def __init__(self, light: Light) -> None:
        full, cut = CELL.overhead_camera, SegmentationConfig()
        width = full.width - 2 * round(cut.margin_x * full.width)
        height = full.height - 2 * round(cut.margin_y * full.height)
        self.camera = PinholeCamera.looking_down(full.X_WC.p, full.f, width, height)
        self._light, self._view = light, LitView(light, width, height)
        self.vision = BoxVision(VisionConfig(segmentation=SegmentationConfig(margin_x=0.0, margin_y=0.0)))

    def close(self) -> None:
        self._view.__exit__(None, None, None)

    def picture(self, things: list[Spawn], rng: np.random.Generator) -> Picture:
        """What the camera sees of these boxes."""
        bodies = {BoxBody(thing.id, thing.dims, 5.0): thing.X_WB for thing in things}
        picture = self._view.picture(np.array(CELL.arm.home), bodies, self.camera).astype(float)
        if self._light.noise:
            picture += rng.normal(0.0, self._light.noise, picture.shape)
        return np.clip(np.round(picture), 0, 255).astype(np.uint8)

    def look(self, spawn: Spawn, rng: np.random.Generator, dims: Dims | None = None) -> IllustratedDetection:
        """Look for a spawned box, expected to be of its own size or another."""
        box = ExpectedBox(spawn.id, dims or spawn.dims, 0.0)
        return self.vision.detect(self.picture([spawn], rng), self.camera, box, TABLE.height, 1.0)


def errors(detection: BoxDetection, spawn: Spawn) -> tuple[float, float]:
    """How far a detection is off [mm, degrees]."""
    assert detection.X_WB is not None
    offset: Array = detection.X_WB.p - spawn.X_WB.p
    turn = (yaw_of(detection.X_WB.q) - yaw_of(spawn.X_WB.q) + np.pi / 2) % np.pi - np.pi / 2
    return float(np.linalg.norm(offset)) * 1e3, float(np.rad2deg(abs(turn)))
