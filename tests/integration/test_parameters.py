"""`ros2 param` tells the truth about every parameter of every node, whatever it is asked to set."""

from __future__ import annotations

import math
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Annotated, Any

import pytest
from pydantic import BaseModel, Field
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter

from integration.harness import Graph
from pack_bringup.graph.graph import load_graph
from pack_core.cells import CELLS
from pack_core.config import AT_ONCE, NEXT_GOAL, Config
from pack_core.errors import ConfigError, PackError
from pack_core.parameter_fields import flat_values
from pack_core.ros.node import CellNode
from pack_core.ros.params import plain

OF_CELLS = {(node.package, node.executable) for cell in CELLS for node in load_graph(cell).nodes}
EXECUTABLES = sorted({*OF_CELLS, ("pack_viewer", "live_node")})
WRONG = [math.nan, -1, -1.0, 0, 1e300, 2**62, "", "fast", True, [], ["a"], [1], [0.5, math.nan], [True]]
"""What somebody may try to set anything to; some of it is right for some parameters."""
OTHERS = {float: [0.5, 0.003, 7.5], int: [1, 2, 17], bool: [True, False], str: ["thesis", "ilqr", "pirs"]}
"""What is right for many parameters of a type."""


class Caught(Exception):
    def __init__(self, cls: type[BaseModel]) -> None:
        self.cls = cls


@cache
def executables() -> dict[str, EntryPoint]:
    """What the packages install, by name."""
    return {point.name: point for point in entry_points(group="console_scripts")}


def config_of(package: str, executable: str, graph: Graph, patch: pytest.MonkeyPatch) -> type[BaseModel]:
    """The configuration class with which a node reads its parameters, found by starting it halfway."""
    module = import_module(executables()[executable].module)
    assert module.__name__.split(".")[0] == package

    def catch(_: CellNode, cls: type[BaseModel], *__: object) -> None:
        raise Caught(cls)

    patch.setattr(CellNode, "read_parameters", catch)
    (node,) = (
        kind for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, CellNode) and kind.__module__ == module.__name__
    )  # fmt: skip
    with pytest.raises(Caught) as caught:
        node(context=graph.context)
    return caught.value.cls


class Told(CellNode):
    """A node with the parameters of a class that keeps the configuration it was told of last."""

    def __init__(self, cls: type[BaseModel], **kwargs: Any) -> None:
        super().__init__("told", **kwargs)
        self.told = self.read_parameters(cls, self._take)

    def _take(self, config: BaseModel) -> None:
        if getattr(config, "label", "") == "forbidden":
            raise PackError("this label is forbidden")
        self.told = config


class Asking:
    """Asks a node through the services that `ros2 param` uses."""

    def __init__(self, graph: Graph, node: CellNode) -> None:
        self._graph, self._name = graph, node.get_name()

    def names(self) -> list[str]:
        return list(self._call(ListParameters, "list_parameters", ListParameters.Request()).result.names)

    def describe(self, names: list[str]) -> dict[str, ParameterDescriptor]:
        request = DescribeParameters.Request(names=names)
        answer = self._call(DescribeParameters, "describe_parameters", request)
        return dict(zip(names, answer.descriptors, strict=True))

    def values(self, names: list[str]) -> dict[str, Any]:
        answer = self._call(GetParameters, "get_parameters", GetParameters.Request(names=names))
        return {
            name: plain(Parameter.from_parameter_msg(_named(name, value)).value)
            for name, value in zip(names, answer.values, strict=True)
        }

    def set(self, name: str, *values: Any) -> list[tuple[bool, str]]:
        """Set one value after the other; whether each was taken, and what was said."""
        wanted = [Parameter(name, value=value).to_parameter_msg() for value in values]
        answer = self._call(SetParameters, "set_parameters", SetParameters.Request(parameters=wanted))
        return [(result.successful, result.reason) for result in answer.results]

    def _call(self, kind: type, name: str, request: Any) -> Any:
        client = self._graph.probe.create_client(kind, f"/{self._name}/{name}")
        self._graph.wait_until(client.service_is_ready)
        future = client.call_async(request)
        self._graph.wait_until(future.done)
        self._graph.probe.destroy_client(client)
        return future.result()


def _named(name: str, value: Any) -> Any:
    message = Parameter(name).to_parameter_msg()
    message.value = value
    return message


def same(a: Any, b: Any) -> bool:
    return a == b or (isinstance(a, float) and isinstance(b, float) and math.isnan(a) and math.isnan(b))


@pytest.fixture(params=EXECUTABLES, ids=lambda found: f"{found[0]}.{found[1]}")
def told(request: Any, graph: Graph, monkeypatch: pytest.MonkeyPatch) -> Told:
    """A node with the parameters of one of the cells' nodes."""
    cls = config_of(*request.param, graph, monkeypatch)
    monkeypatch.undo()
    return graph.start(lambda **kwargs: Told(cls, **kwargs))


def test_every_parameter_says_what_it_is_for_and_what_it_may_be(graph: Graph, told: Told) -> None:
    asking = Asking(graph, told)
    fields = told.parameter_set.fields
    assert set(asking.names()) > set(fields)
    for name, descriptor in asking.describe(list(fields)).items():
        assert len(descriptor.description) > 5, name
        assert descriptor.read_only == (fields[name].changeable is None), name
        has_range = bool(descriptor.integer_range or descriptor.floating_point_range)
        assert has_range == (fields[name].lowest is not None or fields[name].highest is not None), name


def test_a_parameter_is_set_or_refused_with_the_reason_and_never_half(graph: Graph, told: Told) -> None:
    asking, cls = Asking(graph, told), type(told.told)
    fields = told.parameter_set.fields
    for name, field in fields.items():
        before = flat_values(told.told, cls)
        tried = [*WRONG, *OTHERS[field.kind], before[name]]
        if before[name] is None or before[name] == []:
            tried.pop()
        for value, (is_set, said) in zip(tried, asking.set(name, *tried), strict=True):
            assert said, (name, value)
            assert not (is_set and field.changeable is None), name
            if not is_set:
                continue
            before[name] = plain(value)
        now = flat_values(told.told, cls)
        assert now.keys() == before.keys()
        assert all(same(now[other], before[other]) for other in now), name
    now = flat_values(told.told, cls)
    given = {name: value for name, value in now.items() if value is not None}
    for name, value in asking.values(list(given)).items():
        assert same(value, given[name]), name


class Colours(Config):
    """Parameters of every sort."""

    label: Annotated[str, AT_ONCE] = Field(default="blue", description="name of the colour")
    share: Annotated[float, NEXT_GOAL] = Field(default=0.5, gt=0, le=1, description="share of it")
    steps: Annotated[int, AT_ONCE] = Field(default=3, gt=0, lt=9, description="number of steps")
    at_start: int = Field(default=1, description="read once")


@pytest.fixture
def asking(graph: Graph) -> Asking:
    return Asking(graph, graph.start(lambda **kwargs: Told(Colours, **kwargs)))


def test_a_whole_number_may_stand_for_any_number(asking: Asking) -> None:
    assert asking.set("share", 1) == [(True, "counts from the next goal on")]
    assert asking.values(["share"]) == {"share": 1.0}
    assert isinstance(asking.values(["share"])["share"], float)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("share", 0.0, "key 'share' is 0.0; allowed: greater than 0"),
        ("share", "much", "key 'share' is 'much'; allowed: a number"),
        ("steps", 9, "key 'steps' is 9; allowed: less than 9"),
        ("steps", 2.0, "key 'steps' is 2.0; allowed: a whole number"),
        ("at_start", 2, "'at_start' is read when the node starts"),
        ("use_sim_time", True, "'use_sim_time' is read when the node starts"),
        ("label", "forbidden", "this label is forbidden"),
        ("label", None, "'label' cannot be deleted"),
        ("lable", "red", "no parameter 'lable'; did you mean 'label'?"),
    ],
)
def test_a_refusal_says_what_was_given_and_what_is_allowed(
    asking: Asking, name: str, value: Any, reason: str
) -> None:
    ((is_set, said),) = asking.set(name, value)
    assert not is_set
    assert reason in said


def test_ranges_include_what_is_allowed_and_words_say_what_they_cannot(asking: Asking) -> None:
    found = asking.describe(["share", "steps"])
    (share,), (steps,) = found["share"].floating_point_range, found["steps"].integer_range
    assert (share.from_value, share.to_value) == (0.0, 1.0)
    assert found["share"].additional_constraints == "greater than 0"
    assert (steps.from_value, steps.to_value) == (1, 8)


def test_a_value_of_another_type_is_refused_at_start(graph: Graph) -> None:
    with pytest.raises(ConfigError, match="key 'share' is 'much'; allowed: a number"):
        graph.start(lambda **kwargs: Told(Colours, **kwargs), share="much")
