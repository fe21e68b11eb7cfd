"""The simulator under the preset `hardware`: what it publishes is not the truth."""

from __future__ import annotations

import math

import numpy as np
import yaml

from integration.harness import Graph
from integration.packing.sim_rig import EXAMPLE, stamps_of
from pack_bringup.graph.graph import preset_overrides
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_sim.packing.sim_node import PackingSimNode


def start_hardware(graph: Graph) -> PackingSimNode:
    """The node as `pack up packing --preset hardware` starts it."""
    texts = preset_overrides("packing", "hardware")["sim"]
    parameters = {name: yaml.safe_load(text) for name, text in texts.items()}
    graph.probe.listen(contracts.DESCRIPTION, contracts.WRENCH)
    return graph.start(PackingSimNode, **parameters, scene=str(EXAMPLE), real_time_factor=0.0)


def test_the_node_runs_with_what_the_preset_says(graph: Graph) -> None:
    node = start_hardware(graph)
    config, preset = lockstep_config(load_preset("hardware")).simulator, load_preset("hardware")
    given = {name: getattr(node.simulator.config, name) for name in type(config).model_fields}
    assert given == dict(config)
    assert node.simulator.cell == preset.packing_cell()


def test_the_published_description_is_off_and_the_truth_is_not(graph: Graph) -> None:
    node = start_hardware(graph)
    graph.wait_until(lambda: graph.probe.last(contracts.DESCRIPTION))
    told, true = Scene.from_yaml(graph.probe.last(contracts.DESCRIPTION).data), node.simulator.scene
    bounds = node.simulator.config.mismatch
    assert told == node.simulator.description
    for name in [*true.names, true.new_object.name]:
        error = 2 * (told.model_of(name).half_extents - true.model_of(name).half_extents)
        assert 0.0 < np.abs(error).max() <= bounds.size + 1e-9
        assert told.model_of(name).mass != true.model_of(name).mass
    offset = np.abs(np.subtract(told.container.centre, true.container.centre))
    assert 0.0 < offset.max() <= bounds.container + 1e-9


def test_the_published_force_has_noise_and_bias_though_nothing_is_touched(graph: Graph) -> None:
    start_hardware(graph)
    graph.wait_until(lambda: len(stamps_of(graph, contracts.WRENCH)) > 200)
    forces = [message.wrench.force for message in graph.probe.mail[contracts.WRENCH.name][50:]]
    magnitudes = [math.hypot(force.x, force.y, force.z) for force in forces]
    assert 0.5 < np.mean(magnitudes) < 8.0
    assert np.std(np.diff([force.x for force in forces])) > 0.1
