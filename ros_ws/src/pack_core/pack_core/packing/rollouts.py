"""Rollouts that leave out what need not be simulated: objects at rest, and beginnings that are alike.

Objects at rest sleep until something touches them, which takes a third less time. MuJoCo does not store
which objects sleep in the state that a rollout starts from. So the data are reset before every rollout, and
the result depends neither on the number of threads nor on earlier rollouts.

Rollouts that have their first steps in common with the first of the batch, like those of plans that differ
at their end, go on from a copy of its data. They end, to the bit, where they would end alone.
"""

from __future__ import annotations

import copy
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from pack_core.rotations import Array

SHARED_MIN = 4
"""Steps in common that are worth the copy of the data, which takes about as long as a step."""


@dataclass(frozen=True)
class Batch:
    """B rollouts and their results, which are filled in one after the other.

    Attributes:
        x0s: states that they start from `(B, nx)`.
        controls: `(B, T, nu)`.
        xs: states after each control `(B, T, nx)`.
        ys: outputs after each control `(B, T, ny)`.
    """

    x0s: Array
    controls: Array
    xs: Array
    ys: Array

    @property
    def steps(self) -> int:
        """Length T of each rollout."""
        return int(self.controls.shape[1])

    def branches(self) -> tuple[list[int], int]:
        """The rollouts that begin as rollout 0 does, itself among them, and the number of steps in common.

        No rollouts and 0 steps if no other begins like it.
        """
        differs = np.any(self.controls != self.controls[0], axis=2)
        differs |= np.any(self.x0s != self.x0s[0], axis=1)[:, None]
        # at least the last step is left, so that every rollout has one of its own
        common = np.where(differs.any(axis=1), differs.argmax(axis=1), self.steps - 1)
        alike = np.flatnonzero(common >= SHARED_MIN)
        return (alike.tolist(), int(common[alike].min())) if len(alike) > 1 else ([], 0)


class SleepingRollouts:
    """Simulates control sequences of a model, one batch at a time.

    Args:
        model: the model, which is copied.
        threads: number of threads that share a batch.
    """

    def __init__(self, model: mujoco.MjModel, threads: int) -> None:
        self._model = copy.copy(model)
        self._model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        self._common = mujoco.MjData(self._model)
        self._own = threading.local()
        # The pool's threads end when nobody holds the pool any more. They hold what they begin with, so that
        # must not be a method of this object, which holds the pool.
        self._pool = ThreadPoolExecutor(threads, "rollout", _prepare, (self._own, self._model))

    def run(self, x0s: Array, controls: Array) -> tuple[Array, Array]:
        """States `(B, T, nx)` and outputs `(B, T, ny)` after each control `(B, T, nu)`, from `(B, nx)`."""
        x0s, controls = np.ascontiguousarray(x0s), np.ascontiguousarray(controls)
        xs = np.empty((*controls.shape[:2], x0s.shape[1]))
        ys = np.empty((*controls.shape[:2], self._model.nsensordata))
        batch = Batch(x0s, controls, xs, ys)
        branches, shared = batch.branches()
        alone = [i for i in range(len(x0s)) if i not in branches]
        # The pool begins its tasks in order: the common beginning first, and last those that wait for it.
        begun = [self._pool.submit(self._begin, batch, shared)] if branches else []
        tasks = [self._pool.submit(self._simulate, batch, i) for i in alone]
        tasks += [self._pool.submit(self._go_on, batch, i, shared, *begun) for i in branches]
        for task in tasks:
            task.result()  # the results are in xs and ys; asking hands on what a thread raised
        return xs, ys

    def _simulate(self, batch: Batch, i: int) -> None:
        """Simulate rollout `i` from its start to its end."""
        # wakes everything that slept at the end of the last rollout
        mujoco.mj_resetData(self._model, self._own.data)
        self._roll_out(batch, i, batch.x0s, slice(0, batch.steps))

    def _begin(self, batch: Batch, steps: int) -> None:
        """Simulate the first steps of rollout 0, with which others begin, and keep its data."""
        mujoco.mj_resetData(self._model, self._own.data)
        self._roll_out(batch, 0, batch.x0s, slice(0, steps))
        mujoco.mj_copyData(self._common, self._model, self._own.data)

    def _go_on(self, batch: Batch, i: int, steps: int, begun: Future[None]) -> None:
        """Simulate rollout `i` from the end of the common beginning."""
        begun.result()
        batch.xs[i, :steps], batch.ys[i, :steps] = batch.xs[0, :steps], batch.ys[0, :steps]
        mujoco.mj_copyData(self._own.data, self._model, self._common)
        self._roll_out(batch, i, batch.xs[:, steps - 1], slice(steps, batch.steps))

    def _roll_out(self, batch: Batch, i: int, starts: Array, part: slice) -> None:
        """Simulate some steps of rollout `i`, from the states `starts` `(B, nx)` and this thread's data."""
        row, data = slice(i, i + 1), self._own.data
        # The checks of the arguments hold the interpreter's lock, so that the other threads wait for them.
        self._own.rollout.rollout(
            [self._model], [data], starts[row], batch.controls[row, part], nstep=part.stop - part.start,
            # what the solver found last, from which it begins: a rollout would forget it
            initial_warmstart=data.qacc_warmstart[None].copy(),
            state=batch.xs[row, part], sensordata=batch.ys[row, part], skip_checks=True,
        )  # fmt: skip


def _prepare(own: threading.local, model: mujoco.MjModel) -> None:
    # data and rollout of this pool thread alone; with nthread=0 the rollout runs in the thread itself
    own.data, own.rollout = mujoco.MjData(model), Rollout(nthread=0)
