"""How the arm would come to rest on its planned way if it were stopped now, compiled with numba."""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

from pack_core.kinematics import screws
from pack_core.rotations import Array

STRIDE = 8
"""Every so many steps the posture is kept: ways between them count as straight."""
LONGEST = 512
"""Most steps of a prediction; far more than any stop takes."""
STANDS = 1e-6
"""Speed below which a joint stands [rad/s]."""


@numba.njit(cache=True)
def rate_bounds(v: Array, a: Array, rate: float, limit: Array, time: float) -> tuple[float, float]:
    """Bounds of the change of the rate [1/s] within which every joint keeps its acceleration limit.

    At the rate r joints move at r v and accelerate at r^2 a + v dr/dt, which bounds dr/dt for each joint.
    Where the plan stands the rate moves nothing, and may become anything.

    Args:
        v: planned velocities, at rate 1 `(n,)` [rad/s].
        a: planned accelerations `(n,)` [rad/s^2].
        rate: at which the plan is followed.
        limit: acceleration limits `(n,)` [rad/s^2].
        time: from standing still to full rate, at least [s].
    """
    slowest, fastest = -np.inf, 1.0 / time
    is_standing = True
    for j in range(len(v)):
        speed = abs(v[j])
        if speed > STANDS:
            is_standing = False
            along = rate * rate * a[j] * np.sign(v[j])
            slowest = max(slowest, (-limit[j] - along) / speed)
            fastest = min(fastest, (limit[j] - along) / speed)
    if is_standing:
        return -np.inf, np.inf
    return min(slowest, 0.0), max(fastest, 0.0)


@numba.njit(cache=True)
def stop_ahead(
    times: Array, q: Array, v: Array, a: Array, clock: float, rate: float, limit: Array, h: float
) -> tuple[Array, int, float]:
    """Joint positions `(K, n)` on the way to rest, the index at which braking begins, and T_s [s].

    For one cycle the plan is followed on at `rate`; then, as in cycles that do brake, the rate falls as fast
    as `rate_bounds` let it. So what is predicted in a cycle that begins to brake is what the one before
    predicted. Rows are up to `STRIDE` cycles apart, the first one is now.

    Args:
        times: of the plan's rows `(T,)` [s].
        q: planned joint positions `(T, n)` [rad].
        v: planned velocities `(T, n)` [rad/s].
        a: planned accelerations `(T, n)` [rad/s^2].
        clock: present time of the plan [s].
        rate: of the next cycle.
        limit: acceleration limits `(n,)` [rad/s^2].
        h: duration of a cycle [s].
    """
    way, n, braking = np.empty((LONGEST, q.shape[1])), 2, 1
    way[0] = _at(times, q, clock)
    clock += h * rate
    way[1] = _at(times, q, clock)
    stopping, steps = 0.0, 0
    while rate > 0.0 and clock < times[-1] and n < LONGEST - 1:
        slowest, _ = rate_bounds(_at(times, v, clock), _at(times, a, clock), rate, limit, 1.0)
        if slowest == -np.inf:
            break  # the plan stands here
        # The last step ends where the rate does, so that T_s falls evenly from cycle to cycle.
        step = min(h, -rate / slowest) if slowest < 0.0 else h
        slower = max(rate + step * slowest, 0.0)
        clock += 0.5 * step * (rate + slower)
        rate = slower
        stopping += step
        steps += 1
        if steps % STRIDE == 0:
            way[n] = _at(times, q, clock)
            n += 1
    way[n] = _at(times, q, clock)
    return way[: n + 1], braking, stopping


@numba.njit(cache=True)
def _at(times: Array, rows: Array, clock: float) -> Array:
    """The row at a time of the plan, linear between rows and held beyond the ends."""
    i = min(max(int(np.searchsorted(times, clock, side="right")) - 1, 0), len(times) - 2)
    span = times[i + 1] - times[i]
    share = min(max(float((clock - times[i]) / span), 0.0), 1.0) if span > 0.0 else 1.0
    at: Array = (1.0 - share) * rows[i] + share * rows[i + 1]
    return at


@numba.njit(cache=True)
def ways_of_bodies(
    axes: Array, points: Array, way: Array, braking: int, link: npt.NDArray[np.int64], R: Array, p: Array,
    half: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Ways `(k,)` [m] of the fastest corner of k boxes on links, before and after braking begins.

    Args:
        axes: joint axes where all joints are zero `(n, 3)`.
        points: a point of each axis `(n, 3)` [m].
        way: joint positions `(K, n)` [rad].
        braking: index of the row of `way` at which braking begins.
        link: index of the link that carries each box `(k,)`; -1 for none.
        R: orientations of the boxes where all joints are zero `(k, 3, 3)`.
        p: their centres there `(k, 3)` [m].
        half: half edge lengths `(k, 3)` [m].
    """
    corners = np.empty((len(link), 8, 3))
    for i in range(len(link)):
        for c in range(8):
            sign = np.array([2.0 * (c & 1) - 1.0, (c & 2) - 1.0, 0.5 * (c & 4) - 1.0])
            corners[i, c] = screws.turned(R[i], sign * half[i]) + p[i]
    before, after = np.zeros((len(link), 8)), np.zeros((len(link), 8))
    last = np.empty_like(corners)
    for t in range(len(way)):
        R_links, d_links = screws.link_transforms(axes, points, way[t])
        for i in range(len(link)):
            if link[i] < 0:
                continue
            for c in range(8):
                now = screws.turned(R_links[link[i]], corners[i, c]) + d_links[link[i]]
                if t > 0:
                    step = now - last[i, c]
                    size = np.sqrt(screws.dot(step, step))
                    if t <= braking:
                        before[i, c] += size
                    else:
                        after[i, c] += size
                last[i, c] = now
    reacting, stopping = np.zeros(len(link)), np.zeros(len(link))
    for i in range(len(link)):
        # One point of the body: the corner that goes farthest in all.
        farthest = np.argmax(before[i] + after[i])
        reacting[i], stopping[i] = before[i, farthest], after[i, farthest]
    return reacting, stopping
