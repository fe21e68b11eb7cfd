"""The OPC UA server: values, methods and alarms of one object, in a thread of its own."""

from __future__ import annotations

import asyncio
import logging
import socket
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pack_bringup.opcua.alarms import Alarm
from pack_bringup.opcua.view import NEVER, ValueType, Variable
from pack_core.addresses import LOCAL_NAMES
from pack_core.errors import ConfigError, PackError
from pack_core.extras import install_command

try:
    import asyncua
    from asyncua import ua
    from asyncua.crypto.truststore import TrustStore
    from asyncua.crypto.validator import CertificateValidator, CertificateValidatorOptions
except ModuleNotFoundError:  # an extra, which `make setup` does not install
    asyncua = None

INSTALL = install_command("opcua", "--require-hashes")
APPLICATION_URI = "urn:packcell:opcua"
"""Of the server; its certificate has it as subject alternative name."""
NAMESPACE_URI = "urn:packcell:cell"
"""Of the nodes' ids, which are strings: the path after `Cell.`."""
OBJECT = "Cell"
PATIENCE = 3.0
"""Longest time until a method answers [s of wall clock]; clients often give up after four."""
LARGEST_MESSAGE = 2 * 1024 * 1024
"""Largest message that a client may send [bytes]: an order is at most 1 MB."""
START = 60.0
"""Longest time until the server listens [s of wall clock]; it builds the standard's 3,000 nodes first."""

Answer = Callable[[str], None]
"""Takes how a request went, once: empty if it was done, otherwise why not. Any thread may call it."""


@dataclass(frozen=True)
class Method:
    """A request that clients may make.

    Attributes:
        name: of the method.
        what: it does, for whoever browses.
        inputs: name, type and meaning of each argument.
        act: begins it with the arguments, and tells `Answer` how it went; a PackError refuses it at once.
            It is called from a thread for requests, one at a time.
    """

    name: str
    what: str
    inputs: tuple[tuple[str, ValueType, str], ...]
    act: Callable[..., None]


@dataclass(frozen=True)
class ServerSettings:
    """Where the server listens, and who is let in.

    Attributes:
        host: address to listen on; others than this machine's own need a certificate and trusted clients.
        port: to listen on.
        certificate: the server's certificate, DER or PEM; None: connections are not encrypted.
        key: its private key.
        trusted: folder with the certificates of the clients that are let in, or of who has signed them;
            None: every client.
    """

    host: str
    port: int
    certificate: Path | None = None
    key: Path | None = None
    trusted: Path | None = None

    @property
    def address(self) -> str:
        """What clients connect to."""
        return f"opc.tcp://{self.host}:{self.port}"

    def check(self) -> None:
        """Raise ConfigError where anybody could operate the cell from elsewhere, or a file is missing."""
        if (self.certificate is None) != (self.key is None):
            raise ConfigError("--certificate and --key go together: give both or neither")
        if self.trusted is not None and self.certificate is None:
            raise ConfigError("--trusted needs --certificate and --key: who connects is known by encryption")
        if self.host not in LOCAL_NAMES and (self.certificate is None or self.trusted is None):
            raise ConfigError(
                f"host '{self.host}' lets everybody operate the cell who reaches this machine; give "
                "--certificate, --key and --trusted, too (docs/operate/opcua.md), or leave the host out"
            )
        for path in (self.certificate, self.key):
            if path is not None and not path.is_file():
                raise ConfigError(f"no file {path}")
        if self.trusted is not None and not any(self.trusted.glob("*")):
            raise ConfigError(f"--trusted {self.trusted}: no folder with certificates of clients")


def check_installed() -> None:
    """Raise ConfigError, which says how to install it, where asyncua is missing."""
    if asyncua is None:
        raise ConfigError(f"an OPC UA server needs asyncua, which is an extra; run: {INSTALL}")


class OpcUaServer:
    """Serves from its construction on until `stop`.

    Args:
        settings: where it listens.
        title: what browsers show.
        variables: what can be read.
        methods: what can be asked for.
        on_late: is told why a request was not done when that is known after its method has answered.

    Raises:
        ConfigError: it cannot listen there, or a certificate cannot be read.
    """

    def __init__(
        self, settings: ServerSettings, title: str, variables: Iterable[Variable],
        methods: Sequence[Method], on_late: Callable[[str], None],
    ) -> None:  # fmt: skip
        check_installed()
        settings.check()
        _check_port(settings)
        # It logs every client that goes without a word.
        logging.getLogger("asyncua").setLevel(logging.CRITICAL)
        self._settings, self._title = settings, title
        self._variables, self._methods, self._on_late = tuple(variables), methods, on_late
        # One at a time, and not in the server's thread: to read an order may take seconds.
        self._requests = ThreadPoolExecutor(1, "opcua requests")
        self._known: dict[str, Any] = {}
        self._nodes: dict[str, Any] = {}
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="opcua", daemon=True)
        self._thread.start()
        try:
            asyncio.run_coroutine_threadsafe(self._begin(), self._loop).result(START)
        except Exception as error:
            self._end_loop()
            raise ConfigError(f"no OPC UA server at {settings.address}: {error}") from error

    def write(self, values: dict[str, Any]) -> None:
        """Have clients read these values, by path; any thread may call it."""
        changed = {
            path: value for path, value in values.items()
            if path not in self._known or self._known[path] != value
        }  # fmt: skip
        self._known |= changed
        if changed:
            asyncio.run_coroutine_threadsafe(self._write(changed), self._loop).result(START)

    def tell(self, alarms: Iterable[Alarm]) -> None:
        """Tell clients who subscribe to events of alarms that have begun, changed or ended."""
        for alarm in alarms:
            asyncio.run_coroutine_threadsafe(self._tell(alarm), self._loop).result(START)

    def stop(self) -> None:
        """Close all connections, then end."""
        asyncio.run_coroutine_threadsafe(self._server.stop(), self._loop).result(START)
        self._requests.shutdown(cancel_futures=True)
        self._end_loop()

    def _end_loop(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _begin(self) -> None:
        self._server = server = asyncua.Server()
        await server.init()
        await server.set_application_uri(APPLICATION_URI)
        server.set_server_name(self._title)
        server.set_endpoint(self._settings.address)
        server.allow_remote_admin(False)
        server.limits.max_message_size = LARGEST_MESSAGE
        await self._secure(server)
        index = await server.register_namespace(NAMESPACE_URI)
        root = await server.nodes.objects.add_object(_id(index, OBJECT), f"{index}:{OBJECT}")
        self._parents = {"": root}
        for variable in self._variables:
            await self._add_variable(index, variable)
        for method in self._methods:
            await self._add_method(index, root, method)
        self._index = index
        self._alarms = await server.get_event_generator(ua.ObjectIds.AlarmConditionType, root)
        await server.start()

    async def _secure(self, server: Any) -> None:
        if self._settings.certificate is None:
            server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
            return
        await server.load_certificate(self._settings.certificate)
        await server.load_private_key(self._settings.key)
        server.set_security_policy(
            [
                ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt,
                ua.SecurityPolicyType.Aes128Sha256RsaOaep_SignAndEncrypt,
                ua.SecurityPolicyType.Aes256Sha256RsaPss_SignAndEncrypt,
            ]
        )
        if self._settings.trusted is not None:
            store = TrustStore([self._settings.trusted], [])
            await store.load()
            rules = CertificateValidatorOptions.TIME_RANGE | CertificateValidatorOptions.TRUSTED
            rules |= CertificateValidatorOptions.URI | CertificateValidatorOptions.PEER_CLIENT
            server.set_certificate_validator(CertificateValidator(rules, store).validate)

    async def _add_variable(self, index: int, variable: Variable) -> None:
        folder, _, name = variable.path.rpartition(".")
        parent = await self._folder(index, folder)
        empty = [] if variable.is_list else _EMPTY[variable.type]
        kind = getattr(ua.VariantType, variable.type)
        node = await parent.add_variable(
            _id(index, f"{OBJECT}.{variable.path}"), f"{index}:{name}", empty, varianttype=kind
        )
        text = ua.DataValue(ua.Variant(ua.LocalizedText(variable.what)))
        await node.write_attribute(ua.AttributeIds.Description, text)
        self._nodes[variable.path] = (node, kind, variable.is_list)

    async def _folder(self, index: int, path: str) -> Any:
        if path not in self._parents:
            above, _, name = path.rpartition(".")
            parent = await self._folder(index, above)
            self._parents[path] = await parent.add_object(_id(index, f"{OBJECT}.{path}"), f"{index}:{name}")
        return self._parents[path]

    async def _add_method(self, index: int, parent: Any, method: Method) -> None:
        async def call(_: Any, *arguments: Any) -> list[Any]:
            accepted, message = await self._answer(method, [argument.Value for argument in arguments])
            return [ua.Variant(accepted, ua.VariantType.Boolean), ua.Variant(message, ua.VariantType.String)]

        inputs = [_argument(*row) for row in method.inputs]
        outputs = [
            _argument("Accepted", ValueType.BOOLEAN, "whether it was done, or is being done"),
            _argument("Message", ValueType.STRING, "why not, in words"),
        ]
        name = _id(index, f"{OBJECT}.{method.name}")
        node = await parent.add_method(name, f"{index}:{method.name}", call, inputs, outputs)
        text = ua.DataValue(ua.Variant(ua.LocalizedText(method.what)))
        await node.write_attribute(ua.AttributeIds.Description, text)

    async def _answer(self, method: Method, arguments: list[Any]) -> tuple[bool, str]:
        """Whether a request was done or is being done, and why not; every client hears its own."""
        loop = asyncio.get_running_loop()
        told: asyncio.Future[str] = loop.create_future()

        def settle(reason: str) -> None:
            if not told.done():
                told.set_result(reason)
            elif reason:
                self._on_late(reason)

        def tell(reason: str) -> None:
            loop.call_soon_threadsafe(settle, reason)

        def act() -> None:
            try:
                method.act(*arguments, tell)
            except PackError as error:
                tell(str(error))
            except Exception as error:  # nobody foresaw it; the server goes on
                tell(f"{method.name} failed: {error!r}")

        self._requests.submit(act)
        try:
            reason = await asyncio.wait_for(told, PATIENCE)
        except TimeoutError:
            return True, "it takes longer; State and Alarms say how it goes on"
        return not reason, reason

    async def _write(self, values: dict[str, Any]) -> None:
        for path, value in values.items():
            node, kind, is_list = self._nodes[path]
            await node.write_value(ua.Variant(value, kind, is_array=is_list))

    async def _tell(self, alarm: Alarm) -> None:
        event = self._alarms.event
        event.NodeId = ua.NodeId(f"{OBJECT}.Alarms.{alarm.name}", self._index)  # the ConditionId
        event.ConditionName, event.SourceName = alarm.name, alarm.source or OBJECT
        event.Severity, event.Retain = alarm.kind.severity, alarm.is_active
        event.EnabledState = ua.LocalizedText("Enabled")
        setattr(event, "EnabledState/Id", True)
        event.ActiveState = ua.LocalizedText("Active" if alarm.is_active else "Inactive")
        setattr(event, "ActiveState/Id", alarm.is_active)
        event.Message = ua.LocalizedText(alarm.text)
        await self._alarms.trigger()


_EMPTY: dict[ValueType, Any] = {
    ValueType.BOOLEAN: False, ValueType.STRING: "", ValueType.COUNT: 0, ValueType.TIME: NEVER,
}  # fmt: skip


def _id(index: int, path: str) -> Any:
    return ua.NodeId(path, index)


def _argument(name: str, kind: ValueType, what: str) -> Any:
    return ua.Argument(
        Name=name, DataType=ua.NodeId(getattr(ua.ObjectIds, kind)), ValueRank=-1,
        Description=ua.LocalizedText(what),
    )  # fmt: skip


def _check_port(settings: ServerSettings) -> None:
    """Raise ConfigError where the address cannot be listened on: asyncua would only log it."""
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((settings.host, settings.port))
    except OSError as error:
        raise ConfigError(
            f"port {settings.port} of {settings.host}: {error.strerror or error}; choose another one (--port)"
        ) from error
