"""The errors of the force sensor are those that were asked for."""

import numpy as np
import pytest

from pack_sim.packing.wrench_sensor import WrenchSensor, WrenchSensorConfig

ZERO = np.zeros(3)
STEP = 0.001


def readings(config: WrenchSensorConfig, steps: int, seed: int = 0) -> np.ndarray:
    """Of no load at all `(steps, 6)`."""
    sensor = WrenchSensor(config, STEP, np.random.default_rng(seed))
    rows = []
    for _ in range(steps):
        sensor.advance()
        rows.append(np.concatenate(sensor.read(ZERO, ZERO)))
    return np.array(rows)


def test_an_ideal_sensor_says_what_there_is() -> None:
    sensor = WrenchSensor(WrenchSensorConfig(), STEP, np.random.default_rng(0))
    sensor.advance()
    force, torque = sensor.read(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]))
    np.testing.assert_array_equal([*force, *torque], [1, 2, 3, 4, 5, 6])


def test_noise_has_the_configured_size_and_no_memory() -> None:
    rows = readings(WrenchSensorConfig(force_noise=0.5, torque_noise=0.02), 20000)
    assert rows[:, :3].std() == pytest.approx(0.5, rel=0.03)
    assert rows[:, 3:].std() == pytest.approx(0.02, rel=0.03)
    assert abs(np.mean(rows[1:, 0] * rows[:-1, 0])) < 0.03 * 0.5**2


def test_the_bias_keeps_its_size_and_forgets_itself_over_its_time() -> None:
    config = WrenchSensorConfig(force_bias=2.0, torque_bias=0.1, bias_time=0.02)
    rows = readings(config, 40000)
    assert rows[:, :3].std() == pytest.approx(2.0, rel=0.1)
    assert rows[:, 3:].std() == pytest.approx(0.1, rel=0.1)
    lag = round(config.bias_time / STEP)
    correlation = np.mean(rows[lag:] * rows[:-lag], axis=0) / np.var(rows, axis=0)
    assert correlation.mean() == pytest.approx(np.exp(-1.0), abs=0.05)


def test_the_bias_is_there_from_the_start() -> None:
    config = WrenchSensorConfig(force_bias=2.0, bias_time=1e6)
    first = np.array([readings(config, 1, seed)[0, :3] for seed in range(200)])
    assert first.std() == pytest.approx(2.0, rel=0.1)


def test_what_was_set_to_zero_drifts_as_its_bias_does() -> None:
    """E (b_t - b_0)^2 = 2 sigma^2 (1 - exp(-t / tau)), for a bias of size sigma that lasts tau."""
    config, steps, squares = WrenchSensorConfig(force_bias=2.0, bias_time=0.5), 100, []
    for seed in range(300):
        sensor = WrenchSensor(config, STEP, np.random.default_rng(seed))
        sensor.zero()
        np.testing.assert_array_equal(sensor.read(ZERO, ZERO), np.zeros((2, 3)))
        for _ in range(steps):
            sensor.advance()
        squares.append(np.mean(sensor.read(ZERO, ZERO)[0] ** 2))
    assert np.mean(squares) == pytest.approx(2.0 * 2.0**2 * (1.0 - np.exp(-0.2)), rel=0.15)


def test_reading_twice_changes_nothing() -> None:
    sensor = WrenchSensor(WrenchSensorConfig(force_noise=1.0), STEP, np.random.default_rng(0))
    sensor.advance()
    np.testing.assert_array_equal(sensor.read(ZERO, ZERO), sensor.read(ZERO, ZERO))


def test_what_was_set_to_zero_stays_so_when_the_errors_become_larger() -> None:
    sensor = WrenchSensor(WrenchSensorConfig(force_bias=1.0), STEP, np.random.default_rng(0))
    sensor.zero()
    sensor.configure(WrenchSensorConfig(force_bias=5.0))
    np.testing.assert_array_equal(sensor.read(ZERO, ZERO)[0], ZERO)


def test_other_errors_count_at_once_and_none_leave_no_trace() -> None:
    sensor = WrenchSensor(WrenchSensorConfig(), STEP, np.random.default_rng(0))
    sensor.configure(WrenchSensorConfig(force_bias=2.0))
    assert np.abs(sensor.read(ZERO, ZERO)[0]).max() > 0.1
    sensor.configure(WrenchSensorConfig())
    sensor.advance()
    np.testing.assert_array_equal(sensor.read(ZERO, ZERO)[0], ZERO)
