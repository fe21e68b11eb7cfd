"""`ros2 launch pack_bringup blocks.launch.py`: the same graph file as `pack up blocks`."""

from launch_ros.actions import Node

from launch import LaunchDescription
from pack_bringup.graph.graph import load_graph


def generate_launch_description() -> LaunchDescription:
    """One launch action for each node of config/graphs/blocks.yaml."""
    return LaunchDescription(
        Node(
            package=node.package,
            executable=node.executable,
            name=node.name,
            parameters=[str(node.parameters_path), {"use_sim_time": node.use_sim_time}],
            output="screen",
        )
        for node in load_graph("blocks").nodes
    )
