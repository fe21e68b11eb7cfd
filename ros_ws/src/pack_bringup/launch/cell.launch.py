"""Starts a cell as `pack up` does: `ros2 launch pack_bringup cell.launch.py cell:=packing`.

Arguments:
    cell: which cell to start; `ros2 launch pack_bringup cell.launch.py -s` lists them.
    seed: of the generated scene, or of where boxes arrive (packing, palletizing).
    scene: a scene file (packing) or a problem file (blocks).
    order: an order's file, which is sent as a goal once the cell is up (palletizing).
    preset: conditions, a file of config/presets/<cell>; empty: the configuration files as they are.
    calibration: file of a calibrated cell, as `pack calibrate` writes it (packing, palletizing); empty: none.
    domain: ROS domain id; empty: the environment's.
    namespace: of the cell, such as left; empty: none. Two cells of one domain need one each.
    live: whether to serve the page in the browser.
    record: goals, always or never; empty: as config/nodes/<cell>/recorder.yaml has it.
    keystore: a folder of keys without which nobody joins the cell (docs/operate/security.md); empty: none.
    set: parameters over all of these, as in `set:="sim.seed=3 sim.real_time_factor=0.5"`.
"""

from typing import Any

from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription
from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.launch import (
    NO,
    YES,
    enclave_arguments,
    is_yes,
    launch_parameters,
    launch_settings,
    order_command,
    security_environment,
)
from pack_bringup.viewers import PageProcess
from pack_core.addresses import PAGE_PORT
from pack_core.cells import CELLS
from pack_core.namespace import ROOT, checked_namespace

OPTIONAL = {
    "seed": "seed of the scene (packing), or of where boxes arrive (palletizing)",
    "scene": "a scene file (packing) or a problem file (blocks)",
    "order": "an order's file, sent as a goal once the cell is up (palletizing)",
    "preset": "conditions: a file of config/presets/<cell>",
    "calibration": "file of a calibrated cell, as pack calibrate writes it (packing, palletizing)",
    "domain": "ROS domain id; empty: the environment's",
    "namespace": "of the cell; two cells of one domain need one each",
    "record": "goals, always or never; empty: as configured",
    "keystore": "folder of keys, made by tools/keystore.sh; empty: no security",
    "set": "parameters over the files', e.g. sim.real_time_factor=0.5",
}
"""Arguments that may be left out, with their descriptions."""


def generate_launch_description() -> LaunchDescription:
    """The arguments, and the processes of config/graphs/<cell>.yaml once the arguments are known."""
    return LaunchDescription([
        DeclareLaunchArgument("cell", choices=list(CELLS), description="the cell to start"),
        *(DeclareLaunchArgument(name, default_value="", description=what) for name, what in OPTIONAL.items()),
        DeclareLaunchArgument(
            "live", default_value=NO, choices=[YES, NO], description="serve the page in the browser"
        ),
        OpaqueFunction(function=start_cell),
    ])  # fmt: skip


def start_cell(context: LaunchContext) -> list[Any]:
    """The domain, one launch action for each node of the graph file, and what was asked for besides."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ("cell", "live", *OPTIONAL)}
    cell, domain = given["cell"], given["domain"]
    actions: list[Any] = [SetEnvironmentVariable("ROS_DOMAIN_ID", domain)] if domain else []
    keystore = given["keystore"]
    actions += [SetEnvironmentVariable(*item) for item in security_environment(keystore).items()]
    settings = [*launch_settings(cell, given), *given["set"].split()]
    namespace = checked_namespace(given["namespace"])
    actions += start_nodes(cell, given["preset"], settings, keystore, namespace, given["calibration"])
    if is_yes("live", given["live"]):
        (page,) = PageProcess(cell, PAGE_PORT, namespace=namespace).commands().values()
        actions.append(ExecuteProcess(cmd=page, output="screen"))
    if order := order_command(cell, given["order"], namespace):
        actions.append(ExecuteProcess(cmd=order, output="screen"))
    return actions


def start_nodes(
    cell: str, preset: str, settings: list[str], keystore: str = "", namespace: str = ROOT,
    calibration: str = "",
) -> list[Node]:  # fmt: skip
    """One launch action for each node of the graph file."""
    parameters = launch_parameters(cell, preset, settings, calibration)
    return [
        Node(
            package=node.package,
            executable=node.executable,
            name=node.name,
            namespace=namespace,
            parameters=[
                str(node.parameters_path) if namespace == ROOT else node.file_values(),
                parameters[node.name],
            ],
            ros_arguments=enclave_arguments(keystore, cell, node.name),
            output="screen",
        )
        for node in load_graph(cell).nodes
    ]
