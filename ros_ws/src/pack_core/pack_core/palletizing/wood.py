"""A picture of sawn wood."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

SIZE = (256, 512)
LIGHT = np.array([206.0, 172.0, 124.0])


def wood_picture(rng: np.random.Generator) -> npt.NDArray[np.uint8]:
    """A picture `(256, 512, 3)`, RGB, of wood whose grain runs along the width."""
    grain = cv2.GaussianBlur(rng.normal(0.0, 1.0, SIZE), (0, 0), 40.0, sigmaY=1.5)
    fibre = cv2.GaussianBlur(rng.normal(0.0, 1.0, SIZE), (0, 0), 12.0, sigmaY=0.6)
    tone = 22.0 * grain / grain.std() * 0.6 + 5.0 * fibre / fibre.std()
    return np.asarray(np.clip(LIGHT + tone[:, :, None] * np.array([1.0, 0.95, 0.8]), 0, 255), dtype=np.uint8)
