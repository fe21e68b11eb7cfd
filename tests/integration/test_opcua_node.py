"""A cell over OPC UA, as a PLC on this machine reads and operates it."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("asyncua", reason="an extra: see docs/operate/opcua.md")

from asyncua import ua
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from cryptography.x509.oid import ExtendedKeyUsageOID
from pack_interfaces.action import Rearrange
from pack_interfaces.msg import ArmState, RearrangeStatus
from pack_interfaces.srv import ResetScene, StopArm
from std_srvs.srv import Trigger

from integration.blocks.test_blocks_nodes import start_sim
from integration.harness import Graph
from integration.opcua_rig import PREFIX, OpcUaClient
from pack_bringup.opcua.opcua_node import OpcuaNode
from pack_bringup.opcua.server import APPLICATION_URI
from pack_core.blocks.problem_file import parse_problem
from pack_core.paths import config_path, project_root
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.simulation_types import SimulationState

CLIENT_URI = "urn:packcell:test:plc"
TEXT, COUNT = ua.VariantType.String, ua.VariantType.UInt32
COVERED = 13
"""Seed of a goal that the fake machine refuses."""
PROBLEM = sorted(config_path("scenarios", "blocks").glob("*.yaml"))[0].read_text()


class Task(GoalNode):
    """Stands in for the blocks cell's machine: a goal lasts until the test ends it."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("fsm", **kwargs)
        self.requests: list[Rearrange.Goal] = []
        self._result = Rearrange.Result(success=True)
        self._status = self.advertise(contracts.STATUS)
        self.create_timer(0.01, self._turn, clock=self.wall)
        self.take_goals(contracts.REARRANGE, [], 1.0)

    def refusal(self, request: Rearrange.Goal) -> str:
        return "the table is covered" if request.seed == COVERED else ""

    async def pursue(self, request: Rearrange.Goal) -> Rearrange.Result:
        self.requests.append(request)
        self._status.publish(RearrangeStatus(phase="PICK", block="b1"))
        self._status.publish(RearrangeStatus(phase="PLACE", block="b1", picks=1, pushes=2))
        await self.until_goal_ends()
        return self._result

    def end(self, success: bool) -> None:
        self._result = Rearrange.Result(success=success)
        self.end_goal()

    def on_lost_peers(self, peers: list[str]) -> None:
        self.end(False)

    def on_arm_stop(self, reason: str) -> None:
        self.end(False)

    def give_up(self) -> None:
        pass

    def _turn(self) -> None:
        if self.is_cancel_requested:
            self.end(False)


class FakeCell:
    """The blocks cell of which all but the machine is the probe.

    Attributes:
        resets: requests of `/sim/reset`.
        task: takes the goals.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph, self._stops = graph, 0
        self.resets: list[ResetScene.Request] = []
        self.task = graph.start(Task)
        for contract, serve in (
            (shared.STOP_ARM, self._stop), (shared.RESUME_ARM, self._resume), (contracts.RESET, self._reset),
        ):  # fmt: skip
            graph.probe.create_service(contract.type, contract.name, serve)
        graph.probe.send(shared.SIMULATION_STATE, SimulationState(state=SimulationState.STATE_PLAYING))
        graph.probe.send(shared.ARM_STATE, ArmState())

    def _stop(self, request: StopArm.Request, answer: StopArm.Response) -> StopArm.Response:
        self._stops += 1
        state = ArmState(is_stopped=True, is_standing=True, reason=request.reason, stops=self._stops)
        self._graph.probe.send(shared.ARM_STATE, state)
        answer.success = True
        return answer

    def _resume(self, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        self._graph.probe.send(shared.ARM_STATE, ArmState(stops=self._stops))
        answer.success = True
        return answer

    def _reset(self, request: ResetScene.Request, answer: ResetScene.Response) -> ResetScene.Response:
        self.resets.append(request)
        answer.success = True
        return answer


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def cell(graph: Graph) -> FakeCell:
    return FakeCell(graph)


@pytest.fixture
def client(graph: Graph, cell: FakeCell) -> Iterator[OpcUaClient]:
    port = free_port()
    graph.start(OpcuaNode, cell="blocks", port=port)
    opened = OpcUaClient(graph, f"opc.tcp://127.0.0.1:{port}")
    opened.wait_for("State", "Ready")
    yield opened
    opened.close()


def test_an_order_is_chosen_started_and_counted_and_what_fails_is_an_alarm(
    graph: Graph, cell: FakeCell, client: OpcUaClient
) -> None:
    client.follow_alarms()
    page = (project_root() / "docs" / "operate" / "opcua.md").read_text()
    assert [name for name in client.methods() if f"`{name}`" not in page] == []
    assert client.call("Start") == (False, "there is no next order; SetNextOrder chooses one")
    accepted, reason = client.call("SetNextOrder", ("no problem", TEXT), (0, COUNT))
    assert not accepted
    assert "the problem" in reason
    assert client.call("SetNextOrder", (PROBLEM, TEXT), (4, COUNT)) == (True, "")
    assert client.call("Reset") == (True, "")
    assert cell.resets[0].scene == PROBLEM
    assert client.call("Start") == (True, "")
    client.wait_for("State", "Busy")
    assert [(goal.problem, goal.seed) for goal in cell.task.requests] == [(PROBLEM, 4)]
    client.wait_for("Counters.Blocks", 3)
    assert (client.read("Step"), client.read("Item")) == ("PLACE", "b1")
    assert client.read("NextOrder") == ""
    assert client.call("Start")[0] is False
    assert client.call("Reset") == (False, "a goal is in progress; cancel it first")
    cell.task.end(success=True)
    client.wait_for("Counters.GoalsDone", 1)
    client.wait_for("LastGoal.Success", True)
    client.call("SetNextOrder", (PROBLEM, TEXT), (2, COUNT))
    assert client.call("Start") == (True, "")
    client.wait_for("State", "Busy")
    assert client.call("Cancel") == (True, "")
    client.wait_for("Counters.GoalsFailed", 1)
    assert client.read("Counters.Faults") == 1
    assert len(client.read("Alarms.Since")) == len(client.read("Alarms.Active")) == 1
    graph.wait_until(lambda: client.events)
    assert client.events[0][:2] == ("GoalFailed", True)
    client.call("SetNextOrder", (PROBLEM, TEXT), (COVERED, COUNT))
    accepted, reason = client.call("Start")
    assert not accepted
    assert "the table is covered" in reason


def test_a_stop_is_an_alarm_until_it_is_released_and_nothing_but_methods_changes_anything(
    graph: Graph, client: OpcUaClient
) -> None:
    node = client.client.get_node(f"{PREFIX}.State")
    with pytest.raises(ua.UaStatusCodeError):
        client.run(node.write_value("Ready"))
    with pytest.raises(ua.UaStatusCodeError):
        client.run(client.client.nodes.objects.add_object(ua.NodeId("Mine", 2), "2:Mine"))
    client.follow_alarms()
    assert client.call("Stop", ("light curtain 3", TEXT)) == (True, "")
    client.wait_for("Arm.IsStopped", True)
    assert client.read("State") == "Stopped"
    assert client.read("Alarms.Active") == ["STOP over OPC UA, a client of OPC UA: light curtain 3"]
    assert client.call("Resume") == (True, "")
    client.wait_for("Arm.IsStopped", False)
    client.wait_for("Alarms.Active", [])
    graph.wait_until(lambda: len(client.events) == 2)
    assert [event[:2] for event in client.events] == [("ArmStopped", True), ("ArmStopped", False)]


def test_the_simulator_is_stopped_and_put_into_a_scene_which_releases_it(
    graph: Graph, tmp_path: Path
) -> None:
    sim = start_sim(graph, tmp_path, 0.4)
    port = free_port()
    graph.start(OpcuaNode, cell="blocks", port=port)
    client = OpcUaClient(graph, f"opc.tcp://127.0.0.1:{port}")
    client.wait_for("State", "Waiting")  # for the machine
    assert client.call("Stop", ("test", TEXT)) == (True, "")
    client.wait_for("State", "Stopped")
    assert client.call("SetNextOrder", (PROBLEM, TEXT), (0, COUNT)) == (True, "")
    client.call("Reset")
    client.wait_for("Arm.IsStopped", False)
    blocks = {block.id for block in parse_problem(PROBLEM, "problem").blocks}
    with sim.lock:
        assert set(sim.simulator.tags) == blocks
    client.close()


@pytest.fixture
def certificates(tmp_path: Path) -> Path:
    """Key and certificate of a server, of a trusted client, and of another one."""
    import asyncio

    (tmp_path / "trusted").mkdir()
    for name, uri, use, file in (
        ("server", APPLICATION_URI, ExtendedKeyUsageOID.SERVER_AUTH, "server.der"),
        ("plc", CLIENT_URI, ExtendedKeyUsageOID.CLIENT_AUTH, "trusted/plc.der"),
        ("stranger", CLIENT_URI, ExtendedKeyUsageOID.CLIENT_AUTH, "stranger.der"),
    ):
        asyncio.run(
            setup_self_signed_certificate(
                tmp_path / f"{name}.pem", tmp_path / file, uri, "localhost", [use], {"commonName": name}
            )
        )
    return tmp_path


def test_only_trusted_clients_are_let_in_and_only_encrypted(
    graph: Graph, cell: FakeCell, certificates: Path
) -> None:
    port = free_port()
    graph.start(
        OpcuaNode, cell="blocks", port=port, certificate=str(certificates / "server.der"),
        key=str(certificates / "server.pem"), trusted=str(certificates / "trusted"),
    )  # fmt: skip
    url = f"opc.tcp://127.0.0.1:{port}"

    def connect(certificate: str, key: str) -> OpcUaClient:
        paths = [certificates / certificate, certificates / key, certificates / "server.der"]
        string = ",".join(["Basic256Sha256", "SignAndEncrypt", *map(str, paths)])
        return OpcUaClient(graph, url, uri=CLIENT_URI, string=string)

    trusted = connect("trusted/plc.der", "plc.pem")
    trusted.wait_for("Name", "blocks")
    trusted.close()
    with pytest.raises(ua.UaStatusCodeError, match="Untrusted"):
        connect("stranger.der", "stranger.pem")
    with pytest.raises(Exception):  # noqa: B017 - asyncua finds no endpoint without encryption
        OpcUaClient(graph, url)
