"""What a stereo camera measures wrongly, pixel by pixel.

Compiled as a whole, and without the interpreter's lock: beside the physics' thread, a hundred operations on
arrays would each wait for it.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from pack_core.packing.depth import DepthNoise
from pack_core.rotations import Array
from pack_sim.packing.camera_rays import REACH


class PixelErrors(NamedTuple):
    """Sizes of the errors of pixels, which `DepthNoise` explains.

    Attributes:
        lateral: standard deviation of where a pixel looks, along rows and columns [pixels].
        edge: difference between neighbouring depths that is an edge [m].
        flying: share of the pixels at an edge that measure a depth between both sides.
        edge_loss: share of the pixels at an edge that measure nothing.
        axial: standard deviation at a depth of 1 m [m].
        static: share of the variance that stays from image to image.
        some_graze: cosine of the angle of incidence from which on pixels are lost.
        all_graze: cosine of the angle from which on all are.
        loss: share of all pixels that measure nothing.
        step: between depths [m]; 0: none.
    """

    lateral: float
    edge: float
    flying: float
    edge_loss: float
    axial: float
    static: float
    some_graze: float
    all_graze: float
    loss: float
    step: float

    @classmethod
    def of(cls, noise: DepthNoise) -> PixelErrors:
        """The sizes as a cell's configuration has them."""
        some, all_ = np.cos(np.deg2rad(noise.grazing_deg)).tolist()
        return cls(
            noise.lateral, noise.edge, noise.flying, noise.edge_loss, float(noise.axial(1.0)), noise.static,
            some, all_, noise.loss, noise.step,
        )  # fmt: skip


@numba.njit(nogil=True, cache=True, error_model="numpy")  # two equal angles of grazing divide by zero: a step
def with_errors(
    depth: Array, cosine: Array, geoms: npt.NDArray[np.int32], static: Array, alike: Array, losses: Array,
    errors: PixelErrors, rng: np.random.Generator,
) -> Array:  # fmt: skip
    """The image `(height, width)` [m] that a camera measures; 0 where it measures nothing.

    Args:
        depth: what the rays meet `(height, width)` [m], as `RayImage` has it.
        cosine: likewise.
        geoms: likewise.
        static: errors of unit variance that stay.
        alike: those of this image.
        losses: share of pixels that each geom loses `(ngeom + 1,)`; the last one is for no geom.
        errors: sizes of all errors.
        rng: their source.
    """
    height, width = depth.shape
    image = np.zeros((height, width))
    stays, comes = np.sqrt(errors.static), np.sqrt(1.0 - errors.static)
    for v in range(height):
        for u in range(width):
            row = min(max(v + int(np.rint(rng.normal(0.0, errors.lateral))), 0), height - 1)
            column = min(max(u + int(np.rint(rng.normal(0.0, errors.lateral))), 0), width - 1)
            near, far = np.inf, 0.0
            for i in range(max(v - 1, 0), min(v + 2, height)):
                for j in range(max(u - 1, 0), min(u + 2, width)):
                    around = depth[i, j] if depth[i, j] > 0.0 else REACH
                    near, far = min(near, around), max(far, around)
            is_edge, d = far - near > errors.edge, depth[row, column]
            grazing = (errors.some_graze - cosine[row, column]) / (errors.some_graze - errors.all_graze)
            # What is lost at a grazing angle, on a bad surface and anywhere is lost independently.
            kept = 1.0 - min(max(grazing, 0.0), 1.0)
            kept *= (1.0 - losses[geoms[row, column]]) * (1.0 - errors.loss)
            chance, lost = rng.random(), rng.random() >= kept
            if d <= 0.0 or lost or (is_edge and chance > 1.0 - errors.edge_loss):
                continue
            if is_edge and chance < errors.flying:
                d = near + rng.random() * (far - near)
            d += errors.axial * d * d * (stays * static[v, u] + comes * alike[v, u])
            image[v, u] = errors.step * np.rint(d / errors.step) if errors.step > 0.0 else d
    return image
