"""Graph files: which nodes make up a cell, and the command that starts each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Self

import yaml
from pydantic import model_validator

from pack_bringup.graph.executables import find_executable
from pack_core.cells import cells_with, optional_cell_part
from pack_core.config import Config, load_config, merged
from pack_core.errors import ConfigError, PackError
from pack_core.namespace import ROOT
from pack_core.paths import config_path


class NodeEntry(Config):
    """One node of a graph file.

    Attributes:
        parameters: a file below config/ in the ROS 2 parameter format.
    """

    name: str
    package: str
    executable: str
    parameters: str
    use_sim_time: bool = True

    @property
    def parameters_path(self) -> Path:
        """The node's parameter file."""
        return config_path(*Path(self.parameters).parts)

    def file_values(self) -> Mapping[str, Any]:
        """What the parameter file gives, for a node in a namespace: the file's key names one in none."""
        from pack_lockstep.node_parameters import parameters_of

        return parameters_of(self.parameters.removeprefix("nodes/").removesuffix(".yaml"))[0]

    def command(self, overrides: Mapping[str, str] | None = None, namespace: str = ROOT) -> list[str]:
        """The argument list that starts this node as a process of its own.

        Args:
            overrides: parameters that go before the file's, by name, as YAML text.
            namespace: of the node, as rcl writes it.

        Raises:
            PackError: the executable is not installed, or the parameter file does not exist.
        """
        if not self.parameters_path.is_file():
            raise ConfigError(f"node '{self.name}': no parameter file {self.parameters_path}")
        parameters = {"use_sim_time": str(self.use_sim_time).lower(), **(overrides or {})}
        command = [str(find_executable(self.package, self.executable)), "--ros-args"]
        command += ["-r", f"__node:={self.name}"]
        if namespace == ROOT:
            command += ["--params-file", str(self.parameters_path)]
        else:
            command += ["-r", f"__ns:={namespace}"]
            parameters = {**flat_parameters(self.file_values()), **parameters}
        for name, value in parameters.items():
            command += ["-p", f"{name}:={value}"]
        return command


class Graph(Config):
    """The nodes of a cell, in flow order."""

    nodes: tuple[NodeEntry, ...]

    @model_validator(mode="after")
    def _names_are_unique(self) -> Self:
        names = [node.name for node in self.nodes]
        if repeated := sorted({name for name in names if names.count(name) > 1}):
            raise ValueError(f"each node name once, but these are repeated: {', '.join(repeated)}")
        return self

    def only(self, names: Iterable[str]) -> Graph:
        """This graph with no nodes but `names`, still in flow order."""
        wanted = list(names)
        self.check_names(wanted)
        return Graph(nodes=tuple(node for node in self.nodes if node.name in wanted))

    def commands(
        self, overrides: Mapping[str, Mapping[str, str]] | None = None, namespace: str = ROOT
    ) -> dict[str, list[str]]:
        """The command of each node, by node name.

        Args:
            overrides: by node name, the parameters that go before the files', as YAML text.
            namespace: of the nodes, as rcl writes it.
        """
        given = overrides or {}
        self.check_names(given)
        return {node.name: node.command(given.get(node.name), namespace) for node in self.nodes}

    def check_names(self, names: Iterable[str]) -> None:
        """Refuse names that are no nodes of the graph, with those that are, as a PackError."""
        known = [node.name for node in self.nodes]
        for name in names:
            if name not in known:
                raise PackError(f"the graph has no node '{name}'; it has: {', '.join(known)}")


def load_graph(cell: str) -> Graph:
    """The graph of `config/graphs/<cell>.yaml`.

    Raises:
        ConfigError: there is no such cell, or its file is not a valid graph.
    """
    path = config_path("graphs", f"{cell}.yaml")
    if not path.is_file():
        known = sorted(file.stem for file in path.parent.glob("*.yaml"))
        raise ConfigError(f"no cell '{cell}'; cells in {path.parent}: {', '.join(known)}")
    return load_config(Graph, path)


def parse_overrides(settings: Iterable[str]) -> dict[str, dict[str, str]]:
    """Turn `node.parameter=value` settings into overrides by node name.

    Raises:
        PackError: a setting is not of that form.
    """
    overrides: dict[str, dict[str, str]] = {}
    for setting in settings:
        target, equals, value = setting.partition("=")
        node, dot, parameter = target.partition(".")
        if not (node and dot and parameter and equals):
            raise PackError(f"'{setting}' is not a setting; write node.parameter=value, e.g. sim.seed=3")
        overrides.setdefault(node, {})[parameter] = value
    return overrides


def conditions(cell: str, preset: str, calibration: Path | None) -> dict[str, dict[str, str]]:
    """What a preset and a calibration file change, by node and parameter, as YAML text.

    Args:
        cell: one of the register's cells.
        preset: what the cell is like; empty: the configuration files as they are.
        calibration: a file that was made under this preset; None: none.

    Raises:
        ConfigError: the cell has no such preset, takes no calibration, or not this one.
    """
    overrides = preset_overrides(cell, preset)
    if calibration is None:
        return overrides
    if (part := optional_cell_part(cell, "calibration")) is None:
        raise ConfigError(
            f"cell '{cell}' takes no calibration; cells that do: {', '.join(cells_with('calibration'))}"
        )
    return merged(overrides, part(preset, calibration))


def preset_overrides(cell: str, name: str) -> dict[str, dict[str, str]]:
    """What a preset of a cell changes, by node and parameter, as YAML text; nothing where `name` is empty.

    Raises:
        ConfigError: the cell has no presets, or none of this name.
    """
    if not name:
        return {}
    if (part := optional_cell_part(cell, "preset")) is None:
        raise ConfigError(f"cell '{cell}' has no presets; allowed: {', '.join(cells_with('preset'))}")
    overrides: dict[str, dict[str, str]] = part(name)
    return overrides


def flat_parameters(section: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """A preset's section as a node takes it: nested keys as dotted names, values as YAML text."""
    found: dict[str, str] = {}
    for key, value in section.items():
        name = prefix + key
        found |= (
            flat_parameters(value, f"{name}.") if isinstance(value, Mapping) else {name: yaml_line(value)}
        )
    return found


def yaml_line(value: Any) -> str:
    """YAML in one line."""
    text: str = yaml.safe_dump(value, default_flow_style=True, default_style=None, width=float("inf"))
    return text.removesuffix("...\n").strip()
