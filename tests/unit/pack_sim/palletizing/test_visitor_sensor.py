"""The sensor that sees visitors: late, noisy, as far as it reaches; and what is true of their distance."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.visitors import Visitor
from pack_sim.palletizing.crossings import random_visitors, visitors_of
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig
from pack_sim.palletizing.visitor_sensor import Observation, VisitorSensor, VisitorSensorConfig

WALK = Visitor(
    name="person", radius=0.25, length=1.3, path=((2.0, -4.0, 0.9), (2.0, 4.0, 0.9)), speed=1.0
)  # fmt: skip
CONFIG = VisitorSensorConfig()
UP, ALONG_Y = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
BASE = np.array([-1.5, 1.2, 0.3])


def observed(config: VisitorSensorConfig = CONFIG, seconds: float = 6.0) -> list[tuple[float, Observation]]:
    """Observations, each with the time at which it came."""
    sensor = VisitorSensor([WALK], config, BASE, seed=3)
    found = [(time, sensor.observe(time)) for time in np.arange(0.0, seconds, 0.004)]
    return [(time, seen) for time, seen in found if seen is not None]


def test_observations_come_at_the_stated_rate_and_as_late_as_stated() -> None:
    found = observed()
    assert len(found) == pytest.approx(6.0 / CONFIG.period, rel=0.05)
    delays = [time - seen.time for time, seen in found]
    assert min(delays) >= CONFIG.latency - 1e-9
    assert max(delays) < CONFIG.latency + 0.005


def test_the_box_seen_encloses_the_capsule_and_its_velocity_is_about_right() -> None:
    for _, seen in observed()[60:]:
        item, truth = seen.obstacles[0], WALK.at(seen.time)
        assert item.is_moving
        assert np.all(
            np.abs(item.X_WO.p - truth.X_WV.p) + 0.5 * WALK.enclosing_size <= 0.5 * item.size + 0.02
        )
        assert np.linalg.norm(item.v_WO_W - truth.v_WV_W) < 0.35


def test_what_is_out_of_reach_is_not_seen() -> None:
    assert not observed(CONFIG.model_copy(update={"reach": 2.0}))[30][1].obstacles
    assert VisitorSensor([], CONFIG, BASE, seed=0).observe(1.0) is None


def test_who_comes_again_from_elsewhere_is_not_taken_to_have_flown_there() -> None:
    again = WALK.model_copy(update={"path": ((2.0, -1.0, 0.9), (2.0, 1.0, 0.9)), "period": 4.0})
    sensor = VisitorSensor([again], CONFIG, BASE, seed=3)
    seen = [found for time in np.arange(0.0, 9.0, 0.004) if (found := sensor.observe(time)) is not None]
    assert max(np.linalg.norm(each.obstacles[0].v_WO_W) for each in seen) < 1.4


def test_true_distances_are_from_the_arms_surface_to_the_capsules() -> None:
    stands = WALK.model_copy(update={"start": 1e3})
    simulator = PalletSimulator(palletizing_cell(), PalletSimulatorConfig(), visitors=[stands])
    distance = simulator.visitor_distances()["person"]
    tool = simulator.tool_pose().p
    assert 0.0 < distance < np.linalg.norm(tool[:2] - np.array([2.0, -4.0]))
    beside = stands.model_copy(update={"path": (tuple(tool - 0.3 * UP), (0.0, 9.0, 0.0)), "length": 0.1})
    simulator = PalletSimulator(palletizing_cell(), PalletSimulatorConfig(), visitors=[beside])
    assert simulator.visitor_distances()["person"] < 0.1


def test_an_arm_that_a_visitor_runs_into_is_an_unwanted_contact() -> None:
    """The contact watch is what the benchmark's 'no contact' rests on."""
    simulator = PalletSimulator(palletizing_cell(), PalletSimulatorConfig())
    p = simulator.tool_pose().p
    away, at = tuple(p - 1.5 * ALONG_Y), tuple(p)
    rams = Visitor(name="ram", radius=0.2, length=0.5, path=(away, at), speed=1.5)
    simulator = PalletSimulator(palletizing_cell(), PalletSimulatorConfig(), visitors=[rams])
    while simulator.time < rams.duration:
        simulator.step()
    assert any("ram" in event.bodies for event in simulator.contacts.events)


def test_random_visitors_repeat_with_their_seed_and_differ_between_seeds() -> None:
    draws = [random_visitors(np.random.default_rng(seed)) for seed in (1, 1, 2)]
    assert draws[0] == draws[1] != draws[2]
    assert len({visitor.name for visitor in draws[0]}) == 2
    assert visitors_of("random", 4) == visitors_of("random", 4)
    with pytest.raises(ConfigError, match="there are"):
        visitors_of("nobody", 0)
