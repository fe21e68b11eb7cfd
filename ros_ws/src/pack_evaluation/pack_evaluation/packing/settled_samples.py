"""Samples of Algorithm 1 as settled scenes, each with its cost: Figure 3 of the paper for a run of ours."""

from __future__ import annotations

from pathlib import Path

import mujoco
from PIL import Image, ImageDraw

from pack_core.bodies import set_object_poses
from pack_core.camera import Picture
from pack_core.drawing.renderer import ModelView, orbit_camera
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import WALLS, ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_core.packing.settled_sample import SettledSample
from pack_evaluation.captions import caption_font
from pack_evaluation.figures import INK
from pack_evaluation.packing.run import Run

COLUMNS = 3
"""Pictures side by side."""
TILE = (480, 360)
"""Width and height of a sample's picture [px]."""
CAPTION = 34
"""Height of the line below it [px]."""
NEW = (0.20, 0.78, 0.35, 1.0)
"""Colour of the new object, RGBA; the paper's is green, too."""
PALE, GREY = 0.35, 0.75
"""The others' colours are mixed with a grey of this brightness until this share of them is left."""
WALL_OPACITY = 0.3
"""Of the container's walls, so that one sees what is behind them."""
FEASIBLE, INFEASIBLE = "#2f8a46", "#b8402f"
DISTANCE, AZIMUTH_DEG, ELEVATION_DEG = 0.58, 150.0, -42.0
"""The camera: distance from the container's middle [m], and angles [deg]."""


def write_settled_samples(run: Run, path: Path) -> None:
    """Draw the samples of a run's first placement side by side, from the cheapest to the dearest.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    columns = min(COLUMNS, len(run.samples))
    rows = -(-len(run.samples) // columns)
    width, height = TILE[0], TILE[1] + CAPTION
    sheet = Image.new("RGB", (columns * width, rows * height), "white")
    with _SceneView(run.scene) as view:
        for i, sample in enumerate(run.samples):
            corner = (i % columns * width, i // columns * height)
            sheet.paste(Image.fromarray(view.picture(sample)), corner)
            _add_caption(ImageDraw.Draw(sheet), (corner[0], corner[1] + TILE[1]), sample)
    sheet.save(path)


def caption(sample: SettledSample) -> str:
    """Cost of a sample, its place among all, and whether it is a feasible placement."""
    places = {0.0: "the cheapest", 1.0: "the dearest"}
    place = places.get(sample.rank, f"dearer than {100 * sample.rank:.0f} %")
    return f"cost {sample.cost:.2f}, {place}, {'feasible' if sample.is_feasible else 'not feasible'}"


def _add_caption(draw: ImageDraw.ImageDraw, corner: tuple[int, int], sample: SettledSample) -> None:
    x, y = corner
    draw.rectangle((x, y, x + 8, y + CAPTION), fill=FEASIBLE if sample.is_feasible else INFEASIBLE)
    draw.text((x + 16, y + CAPTION / 2), caption(sample), font=caption_font(17), fill=INK, anchor="lm")


class _SceneView(ModelView):
    """Draws the settled scenes of samples without an arm, the new object in its own colour."""

    def __init__(self, scene: Scene) -> None:
        model = build_model(
            scene, packing_cell(), timestep=0.006, arm=ArmRole.ABSENT, held=HeldRole.FREE, surroundings=True
        )
        for name in WALLS:
            model.geom(name).rgba[3] = WALL_OPACITY
        for name in scene.names:
            colour = model.geom(name).rgba
            colour[:3] = PALE * colour[:3] + (1.0 - PALE) * GREY
        model.geom(scene.new_object.name).rgba[:] = NEW
        super().__init__(model, *TILE)
        centre = (*scene.container.centre, 0.5 * scene.container.height)
        self._camera = orbit_camera(centre, DISTANCE, AZIMUTH_DEG, ELEVATION_DEG)

    def picture(self, sample: SettledSample) -> Picture:
        set_object_poses(self._model, self._data, dict(sample.poses))
        mujoco.mj_forward(self._model, self._data)
        self._update_scene(self._camera)
        return self._render()
