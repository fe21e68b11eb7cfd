"""The law for drivers in C++, docs/cells/packing/libfranka/law.hpp, is that of the simulator."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import numpy.typing as npt
import pytest

from pack_core.joints import Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.paths import project_root
from pack_core.robots.panda import PANDA
from pack_sim.brakes import LATE_BRAKE_TIME
from unit.pack_sim.packing.driver import Driver

Array = npt.NDArray[np.float64]

HOME = np.array(packing_cell().robot.home)
MASS = np.array([1.5, 2.5, 1.5, 1.2, 0.2, 0.2, 0.1])
WRAPPER = """
#include "law.hpp"
static Law law;
static Plan plan;
static Joints joints(const double* x) { Joints y; std::copy(x, x + 7, y.begin()); return y; }
extern "C" void begin(double brake_time) { law = Law{}; plan = Plan{}; law.brake_time = brake_time; }
extern "C" void send(double time, double received, int rows, const double* offsets, const double* values) {
  plan.time = time; plan.received = received; plan.rows = rows;
  for (int i = 0; i < rows; ++i) {
    plan.offset[i] = offsets[i];
    plan.q[i] = joints(values + 21 * i);
    plan.v[i] = joints(values + 21 * i + 7);
    plan.tau[i] = joints(values + 21 * i + 14);
  }
}
extern "C" void torque(double now, const double* q, const double* v, const double* mass, double* tau) {
  const Joints found = law.torque(plan, now, joints(q), joints(v), joints(mass));
  std::copy(found.begin(), found.end(), tau);
}
"""


@pytest.fixture(scope="module")
def law(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("needs g++")
    folder = tmp_path_factory.mktemp("law")
    source, library = folder / "law.cpp", folder / "law.so"
    source.write_text(WRAPPER)
    header = project_root() / "docs" / "cells" / "packing" / "libfranka"
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-I{header}"]
    subprocess.run([compiler, *flags, str(source), "-o", str(library)], check=True)
    return ctypes.CDLL(str(library))


class CompiledLaw:
    """The compiled law behind the interface of the simulator's driver.

    Args:
        library: the law and its wrapper.
    """

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library
        library.begin(ctypes.c_double(LATE_BRAKE_TIME))

    def accept(self, setpoints: Setpoints, time: float) -> None:
        assert setpoints.tau is not None
        offsets = np.ascontiguousarray(setpoints.offsets)
        values = np.ascontiguousarray(np.hstack([setpoints.q, setpoints.v, setpoints.tau]))
        stamps = ctypes.c_double(setpoints.time), ctypes.c_double(time)
        self._library.send(*stamps, len(offsets), pointer(offsets), pointer(values))

    def torque(self, time: float, q: Array, v: Array) -> Array:
        tau = np.zeros(7)
        arguments = [pointer(np.ascontiguousarray(x)) for x in (q, v, MASS, tau)]
        self._library.torque(ctypes.c_double(time), *arguments)
        return np.clip(tau, -PANDA.limits.effort, PANDA.limits.effort)


def pointer(values: Array) -> ctypes._Pointer[ctypes.c_double]:
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def plan(rng: np.random.Generator, time: float) -> Setpoints:
    rows = int(rng.integers(1, 14))
    q, v, tau = (rng.uniform(-bound, bound, (rows, 7)) for bound in (0.05, 0.2, 10.0))
    return Setpoints(time, 0.02 * np.arange(rows), HOME + q, v, tau)


@pytest.mark.parametrize("seed", range(3))
def test_the_law_for_libfranka_exerts_the_torques_of_the_simulator(law: ctypes.CDLL, seed: int) -> None:
    """Plans come early, late and in time, and not at all for so long that the arm brakes."""
    rng = np.random.default_rng(seed)
    simulator, compiled = Driver(packing_cell().robot, watchdog=0.1), CompiledLaw(law)
    is_held = 0
    for step in range(2000):
        now = 0.001 * step + 0.0005  # between the rows, so that no plan ends by rounding
        if rng.random() < (0.03 if step % 1000 < 700 else 0.0):
            setpoints = plan(rng, 0.001 * step + rng.uniform(-0.1, 0.06))
            simulator.accept(setpoints, now)
            compiled.accept(setpoints, now)
        q, v = HOME + rng.normal(scale=0.02, size=7), rng.normal(scale=0.004, size=7)
        expected = simulator.torque(now, q, v, lambda: np.diag(MASS))
        np.testing.assert_allclose(compiled.torque(now, q, v), expected, atol=1e-9)
        is_held += simulator.is_holding
    assert 200 < is_held < 1800, "both following and holding were compared"
