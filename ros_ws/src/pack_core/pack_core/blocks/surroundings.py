"""What only pictures of the blocks cell need: table, floor, sky and lights."""

from __future__ import annotations

import mujoco

from pack_core.blocks.cell import BlocksCell
from pack_core.room import Light, add_lights, add_sky, add_table, add_tiles


def add_surroundings(spec: mujoco.MjSpec, cell: BlocksCell) -> None:
    """Add a table, a floor, a sky and soft light from above."""
    visual = spec.visual
    visual.quality.shadowsize = 4096
    visual.headlight.ambient = (0.42, 0.42, 0.42)
    visual.headlight.diffuse, visual.headlight.specular = (0.2, 0.2, 0.2), (0.0, 0.0, 0.0)
    visual.map.shadowclip = 1.4
    visual.map.znear, visual.map.zfar = 0.02, 30.0
    add_sky(spec, (0.95, 0.96, 0.98), (0.70, 0.76, 0.82))
    add_tiles(spec, "tiles", (0.70, 0.71, 0.73), (0.62, 0.63, 0.65))
    spec.add_material(name="table", rgba=(0.62, 0.52, 0.40, 1.0), specular=0.05, shininess=0.1)
    add_table(spec, cell.table.centre, cell.table.size, top="table", floor="tiles")
    x, y = cell.workspace.centre
    lights = (
        Light((x + 0.7, y - 0.9, 2.5), (-0.3, 0.4, -1.0), 0.40, True),
        Light((x - 1.0, y + 1.2, 2.0), (0.5, -0.6, -1.0), 0.15, False),
    )
    add_lights(spec, lights, specular=0.1)
