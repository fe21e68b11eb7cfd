"""Starts a cell as `pack up` does: `ros2 launch pack_bringup cell.launch.py cell:=packing`.

Arguments:
    cell: which cell to start; `ros2 launch pack_bringup cell.launch.py -s` lists them.
    preset: conditions, a file of config/presets; empty: the configuration files as they are.
    set: parameters over the files', as in `set:="sim.seed=3 sim.real_time_factor=0.5"`.
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription
from pack_bringup.graph.graph import launch_parameters, load_graph
from pack_core.cells import CELLS


def generate_launch_description() -> LaunchDescription:
    """The arguments, and the nodes of config/graphs/<cell>.yaml once the arguments are known."""
    return LaunchDescription([
        DeclareLaunchArgument("cell", choices=list(CELLS), description="the cell to start"),
        DeclareLaunchArgument("preset", default_value="", description="conditions: a file of config/presets"),
        DeclareLaunchArgument(
            "set", default_value="", description="parameters over the files', e.g. sim.seed=3"
        ),
        OpaqueFunction(function=start_nodes),
    ])  # fmt: skip


def start_nodes(context: LaunchContext) -> list[Node]:
    """One launch action for each node of the graph file."""
    cell, preset, settings = (
        LaunchConfiguration(name).perform(context) for name in ("cell", "preset", "set")
    )
    parameters = launch_parameters(cell, preset, settings.split())
    return [
        Node(
            package=node.package,
            executable=node.executable,
            name=node.name,
            parameters=[str(node.parameters_path), parameters[node.name]],
            prefix=" ".join(node.prefix),
            output="screen",
        )
        for node in load_graph(cell).nodes
    ]
