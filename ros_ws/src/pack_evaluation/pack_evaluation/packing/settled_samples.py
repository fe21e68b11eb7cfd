"""Samples of Algorithm 1 as settled scenes, each with its cost: Figure 3 of the paper for a run of ours."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image, ImageDraw

from pack_core.bodies import set_object_poses
from pack_core.drawing.renderer import open_renderer
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import WALLS, ArmRole, HeldRole, build_model
from pack_core.packing.scene import Scene
from pack_core.packing.settled_sample import SettledSample
from pack_evaluation.captions import INK, caption_font
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.view import Picture

COLUMNS = 3
TILE = (480, 360)
"""Width and height of a sample's picture [px]."""
CAPTION = 34
"""Height of the line below it [px]."""
NEW = (0.20, 0.78, 0.35, 1.0)
"""Colour of the new object, RGBA; the paper's is green, too."""
PALE, GREY = 0.35, 0.75
"""The others' colours are mixed with a grey of this brightness until this share of them is left."""
WALL_OPACITY = 0.3
FEASIBLE, INFEASIBLE = "#2f8a46", "#b8402f"
VIEW = {"distance": 0.58, "azimuth": 150.0, "elevation": -42.0}
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
    for i, (sample, picture) in enumerate(zip(run.samples, _pictures(run.scene, run.samples), strict=True)):
        corner = (i % columns * width, i // columns * height)
        sheet.paste(Image.fromarray(picture), corner)
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


def _pictures(scene: Scene, samples: tuple[SettledSample, ...]) -> list[Picture]:
    """Each settled scene without an arm, the new object in its own colour."""
    model = build_model(
        scene, packing_cell(), timestep=0.006, arm=ArmRole.ABSENT, held=HeldRole.FREE, surroundings=True
    )
    for name in WALLS:
        model.geom(name).rgba[3] = WALL_OPACITY
    for name in scene.names:
        colour = model.geom(name).rgba
        colour[:3] = PALE * colour[:3] + (1.0 - PALE) * GREY
    model.geom(scene.new_object.name).rgba[:] = NEW
    data, camera = mujoco.MjData(model), mujoco.MjvCamera()
    camera.lookat[:] = (*scene.container.centre, 0.5 * scene.container.height)
    camera.distance, camera.azimuth, camera.elevation = VIEW["distance"], VIEW["azimuth"], VIEW["elevation"]
    pictures = []
    with closing(open_renderer(model, *TILE)) as renderer:
        for sample in samples:
            set_object_poses(model, data, dict(sample.poses))
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera)
            renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
            pictures.append(np.array(renderer.render(), dtype=np.uint8))
    return pictures
