"""S_p of ISO/TS 15066 against its closed form for a robot that brakes evenly."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_motion.safety.protective_distance import PredictedStop, ProtectiveSeparation, protective_distances

CONFIG = ProtectiveSeparation(
    person_speed=1.6, top_speed=3.0, reaction=0.3, intrusion=0.1, seen_uncertainty=0.06,
    robot_uncertainty=0.04, reserve=0.0, speed_reserve=0.0, oldest=0.1, blind=0.5,
)  # fmt: skip


def even_stop(v: float, a: float) -> PredictedStop:
    """From the speed v within T_r, as the robot reacts as fast as people do."""
    return PredictedStop(v / a, np.array([v * CONFIG.reaction]), np.array([0.5 * v**2 / a]))


@pytest.mark.parametrize(
    ("v", "a", "S_p"),
    [(0.25, 1.2, 1.11), (1.0, 1.2, 2.73), (3.0, 1.2, 9.33), (1.0, 4.0, 1.505), (2.0, 4.0, 2.58)],
)
def test_the_distance_from_a_person_who_walks_is_that_of_the_formula(v: float, a: float, S_p: float) -> None:
    found = protective_distances(CONFIG, np.array([0.0]), 0.0, even_stop(v, a))
    np.testing.assert_allclose(found, [[S_p]], atol=0.005)


@given(v=st.floats(0.01, 5.0), a=st.floats(0.5, 10.0), faster=st.floats(0.01, 1.0), speed=st.floats(0.0, 5.0))
def test_a_faster_robot_and_a_faster_person_need_more(
    v: float, a: float, faster: float, speed: float
) -> None:
    def S_p(v: float, speed: float) -> float:
        return float(protective_distances(CONFIG, np.array([speed]), 0.0, even_stop(v, a))[0, 0])

    assert S_p(v + faster, speed) > S_p(v, speed)
    assert S_p(v, speed + faster) >= S_p(v, speed)
    assert S_p(v, 0.0) == S_p(v, CONFIG.person_speed)
    assert S_p(v, 9.0) == S_p(v, CONFIG.top_speed)


@given(age=st.floats(0.0, 1.0), speed=st.floats(1.6, 3.0))
def test_since_they_were_seen_people_have_gone_on_and_the_robot_has_not(age: float, speed: float) -> None:
    stop, speeds = even_stop(1.0, 4.0), np.array([speed])
    longer = protective_distances(CONFIG, speeds, age, stop) - protective_distances(CONFIG, speeds, 0.0, stop)
    np.testing.assert_allclose(longer, speed * age, atol=1e-12)


def test_each_body_has_its_distance_from_each_person() -> None:
    stop = PredictedStop(0.4, np.array([0.0, 0.4]), np.array([0.0, 0.3]))
    found = protective_distances(CONFIG, np.array([0.5, 2.0]), 0.0, stop)
    np.testing.assert_allclose(found, np.array([[1.6, 2.0]]) * 0.7 + np.array([[0.0], [0.7]]) + 0.2)
