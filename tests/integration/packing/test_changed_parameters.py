"""What is changed while the packing cell's nodes run does count."""

from __future__ import annotations

import numpy as np
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter

from integration.harness import Graph
from integration.packing.sim_rig import stamps_of, start_sim
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp
from pack_mpc.mpc_node import MpcNode


def put(node: Node, name: str, value: object) -> str:
    """Set a parameter as a service call does; what is said to it."""
    result = node.set_parameters_atomically([Parameter(name, value=value)])
    return result.reason if result.successful else f"refused: {result.reason}"


def test_time_runs_as_fast_as_it_is_told_to(graph: Graph) -> None:
    sim = start_sim(graph, factor=0.05)
    graph.probe.listen(shared.REAL_TIME_FACTOR)
    assert put(sim, "real_time_factor", 0.15) == "counts at once"  # as fast as the busiest machine can
    graph.wait_until(
        lambda: any(
            message.data == pytest.approx(0.15, rel=0.2)
            for message in graph.probe.mail[shared.REAL_TIME_FACTOR.name]
        )
    )


def test_noise_is_as_it_is_told_to_be(graph: Graph) -> None:
    sim = start_sim(graph)
    assert put(sim, "wrench_sensor.force_noise", 3.0) == "counts at once"
    assert put(sim, "mocap.noise_std", 0.0) == "counts at once"
    since = sim.simulator.time
    graph.wait_until(lambda: stamps_of(graph, contracts.WRENCH)[-1] > since + 0.3)
    mail = graph.probe.mail[contracts.WRENCH.name]
    heard = [message.wrench.force for message in mail if from_stamp(message.header.stamp) > since + 0.02]
    forces = np.array([[force.x, force.y, force.z] for force in heard])
    assert np.diff(forces, axis=0).std() == pytest.approx(3.0 * np.sqrt(2.0), rel=0.3)


def test_weights_and_optimizer_count_from_the_next_goal_on_and_what_there_is_not_is_refused(
    graph: Graph,
) -> None:
    mpc = graph.start(MpcNode)
    assert put(mpc, "weights", "table_1") == "counts from the next goal on"
    assert put(mpc, "controller.optimizer", "ilqr") == "counts from the next goal on"
    assert (mpc._config.weights, mpc._config.controller.optimizer) == ("table_1", "ilqr")
    assert "allowed: sgn, ilqr, judo" in put(mpc, "controller.optimizer", "ilqrr")
    assert "table_1" in put(mpc, "weights", "heavy")
    assert put(mpc, "worker.latency", 0.1).startswith(
        "refused: 'worker.latency' is read when the node starts"
    )
    assert (mpc._config.weights, mpc._config.controller.optimizer) == ("table_1", "ilqr")
