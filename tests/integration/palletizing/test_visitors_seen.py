"""Visitors of the simulated cell reach the motion and the viewers, as messages."""

from __future__ import annotations

import numpy as np

from integration.harness import Graph
from integration.simulation_rig import pause
from pack_core.palletizing.visitors import load_visitors
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import from_obstacles
from pack_sim.palletizing.pallet_sim_node import PalletSimNode


def test_the_sensor_says_where_a_visitor_was_and_frames_show_where_it_is(graph: Graph) -> None:
    """The message is late by the sensor's latency, and says so by its stamp."""
    sim = graph.start(PalletSimNode, **{"real_time_factor": 1.0, "camera.width": 640, "visitors": "person"})
    graph.probe.listen(motion.MOTION_OBSTACLES, shared.TF)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_OBSTACLES) is not None)
    seen = graph.probe.last(motion.MOTION_OBSTACLES)
    (person,) = from_obstacles(seen.obstacles)
    truth = load_visitors("person")[0].at(from_stamp(seen.header.stamp)).X_WV
    assert person.is_moving
    assert np.linalg.norm(person.X_WO.p - truth.p) < 0.08

    def frames() -> set[str]:
        messages = graph.probe.mail[shared.TF.name]
        return {item.child_frame_id for message in messages for item in message.transforms}

    graph.wait_until(lambda: "person" in frames())

    def lateness() -> float:
        return float(sim.simulator.time - from_stamp(graph.probe.last(motion.MOTION_OBSTACLES).header.stamp))

    pause(graph)  # the last message may be on its way
    graph.wait_until(lambda: lateness() < 0.15)
    assert lateness() >= 0.09


def test_a_cell_without_visitors_publishes_no_obstacles(graph: Graph) -> None:
    graph.start(PalletSimNode, **{"real_time_factor": 1.0, "camera.width": 640})
    graph.probe.listen(shared.CLOCK, motion.MOTION_OBSTACLES)
    graph.wait_until(lambda: graph.probe.last(shared.CLOCK) is not None)
    graph.wait_until(lambda: from_stamp(graph.probe.last(shared.CLOCK).clock) > 0.5)
    assert graph.probe.last(motion.MOTION_OBSTACLES) is None
