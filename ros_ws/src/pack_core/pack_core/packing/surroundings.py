"""Table, floor, sky and lights, which only pictures of the packing cell need."""

from __future__ import annotations

import mujoco

from pack_core.packing.scene import Container
from pack_core.room import Light, add_lights, add_sky, add_table, add_tiles


def add_surroundings(spec: mujoco.MjSpec, container: Container) -> None:
    """Add a table, a floor, a sky and lights that cast soft shadows."""
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = 1920, 1080
    visual.quality.shadowsize = 4096
    visual.headlight.ambient = (0.34, 0.34, 0.34)
    visual.headlight.diffuse, visual.headlight.specular = (0.25, 0.25, 0.25), (0.0, 0.0, 0.0)
    visual.map.shadowclip = 1.4
    add_sky(spec, (0.95, 0.96, 0.98), (0.70, 0.76, 0.82))
    add_tiles(spec, "tiles", (0.70, 0.71, 0.73), (0.62, 0.63, 0.65), reflectance=0.03)
    spec.add_material(name="table", rgba=(0.80, 0.76, 0.70, 1.0), specular=0.1, shininess=0.2)
    add_table(spec, (0.35, 0.0), (1.5, 1.2), top="table", floor="tiles")
    x, y = container.centre
    lights = (
        Light((x + 0.6, y - 0.8, 2.5), (-0.35, 0.4, -1.0), 0.42, True),
        Light((x - 1.0, y + 1.2, 2.0), (0.5, -0.6, -1.0), 0.16, False),
    )
    add_lights(spec, lights, specular=0.15)
