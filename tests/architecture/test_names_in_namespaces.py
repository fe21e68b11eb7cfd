"""Whatever a node publishes, hears or asks is below the namespace of its cell (pack_core/ros/node.py)."""

import ast
from collections.abc import Iterator

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
NO_CELL_NODES = {
    "pack_core/pack_core/ros/node.py",  # has the rule
    "pack_bringup/pack_bringup/ros/status_listener.py",  # completes the names itself
    "pack_bringup/pack_bringup/recording/ros/bag_player.py",  # plays into a domain of its own
    "pack_bringup/pack_bringup/robustness/ros/cell_observer.py",  # observes cells that it has started itself
}
"""Modules with nodes that are no `CellNode`, which puts names into the namespace."""


def syntax(*words: str) -> Iterator[tuple[str, ast.AST]]:
    """Every node of the syntax trees of the modules that have one of the words, with the module."""
    for path in SOURCES.glob("*/*/**/*.py"):
        text = path.read_text()
        if any(word in text for word in words):
            yield from ((str(path.relative_to(SOURCES)), node) for node in ast.walk(ast.parse(text)))


def is_call_of(node: ast.AST, *names: str) -> bool:
    return isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in names


def test_actions_which_rclpy_makes_past_a_nodes_own_methods_have_names_in_the_cell() -> None:
    kinds = ("ActionServer", "ActionClient")
    calls = [node for _, node in syntax(*kinds) if is_call_of(node, *kinds)]
    assert calls
    assert [ast.unparse(call) for call in calls if "in_cell(" not in ast.unparse(call.args[2])] == []


def test_nodes_are_cell_nodes() -> None:
    makers = {path for path, node in syntax("create_node") if is_call_of(node, "create_node")}
    derived = {
        path for path, node in syntax("(Node")
        if isinstance(node, ast.ClassDef) and "Node" in [ast.unparse(base) for base in node.bases]
    }  # fmt: skip
    assert makers | derived <= NO_CELL_NODES
