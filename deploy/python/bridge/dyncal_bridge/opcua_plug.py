"""An OPC UA server with an object a bench: package asyncua. Clients read and subscribe, no more.

Below Objects/dyncal, namespace urn:dyncal:bridge, string node ids as the paths below:

    BENCH/state/MEMBER                                 of the run, its step, its analysis
    BENCH/sources/SOURCE/MEMBER                        of an instrument
    BENCH/points/SOURCE/CHANNEL/MEMBER                 of the last result of the channel
    BENCH/transfer_functions/SOURCE/CHANNEL/MEMBER     of its means: arrays over the frequencies

"/" and "%" in names are written as %2F and %25. Members and numbers are those of the documents; a
member `json` has the whole document, for whoever wants it in one read. All members of one document
have its time as source timestamp, by which a client knows those that belong together. A number
that is not known has the status BadNoDataAvailable; what is of an earlier run than the newest,
UncertainLastUsableValue.
"""

from __future__ import annotations

import asyncio
import datetime
import gc
import json
import logging
import math
import threading
from typing import Any

from asyncua import Server, ua
from asyncua.common.node import Node
from asyncua.server.user_managers import User, UserManager, UserRole

from dyncal_bridge.document import BridgeError, ChannelSamples, Document, Item, Members, NewRun
from dyncal_bridge.plug import Plug, path_of
from dyncal_bridge.settings import OpcuaSettings

NAMESPACE = "urn:dyncal:bridge"
MAX_OBJECTS = 2048  # with some 30 variables each
OPEN_TIMEOUT_S, SERVE_TIMEOUT_S, STOP_TIMEOUT_S = 120.0, 30.0, 1.0
WHOLE = {
    *("step", "repetition", "repetitions", "points", "planned_steps", "lost", "attempt"),
    *("received", "lost_in_device", "lost_in_transit", "duplicates", "rejected"),
    *("stamps_not_trusted", "dropped_in_service", "planned_utc_ns", "published_utc_ns"),
}
TEXTS = {"message", "problem", "excited_axis", "group_delay_problem"}
logging.getLogger("asyncua").setLevel(logging.ERROR)


class Onlookers(UserManager):  # type: ignore[misc]
    """Everybody may read; nobody may write, call or add nodes."""

    def get_user(
        self, iserver: Any, username: Any = None, password: Any = None, certificate: Any = None
    ) -> User:
        return User(role=UserRole.User, name=username)


def escaped(name: str) -> str:
    return name.replace("%", "%25").replace("/", "%2F")


def freedom(value: Any, k: Any) -> Any:
    """Degrees of freedom: null is infinite where there is a coverage factor."""
    return math.inf if value is None and k is not None else value


def flat(members: Members) -> Members:
    """Members that OPC UA has types for; rows of means as arrays; the whole as `json`."""
    flattened: Members = {}
    for name, value in members.items():
        if name == "transfer_function":
            columns = dict.fromkeys(key for row in value for key in row if key != "flags")
            for column in columns:
                each = [row.get(column) for row in value]
                if column.startswith("nu_eff_"):
                    factors = [row.get(column.replace("nu_eff", "k")) for row in value]
                    each = list(map(freedom, each, factors))
                if column == "flag_names":
                    each = [" ".join(names or []) for names in each]
                if column not in ("channel", "unit", "excited_axis"):
                    flattened[f"means_{column}"] = each
        elif name.startswith("nu_eff_"):
            flattened[name] = freedom(value, members[name.replace("nu_eff", "k")])
        elif name == "group_delay" and value:
            for key in value:
                factor = value.get(key.replace("nu_eff", "k"))
                is_freedom = key.startswith("nu_eff")
                one = freedom(value[key], factor) if is_freedom else value[key]
                flattened |= {} if key == "channel" else {f"group_delay_{key}": one}
        elif not isinstance(value, (dict, list)) or name in ("flags", "flag_names"):
            flattened[name] = value
    return flattened | {"json": json.dumps(members, ensure_ascii=False, allow_nan=False)}


def variant_of(name: str, value: Any) -> ua.Variant:
    """The type follows from the member, so that it never changes."""
    if isinstance(value, list):
        if name in ("flags", "flag_names") or any(isinstance(one, str) for one in value):
            texts = [str(one) for one in value]
            return ua.Variant(texts, ua.VariantType.String, is_array=True)
        if name.removeprefix("means_") in WHOLE:
            return ua.Variant(value, ua.VariantType.Int64, is_array=True)
        numbers = [math.nan if one is None else float(one) for one in value]
        return ua.Variant(numbers, ua.VariantType.Double, is_array=True)
    if isinstance(value, bool):
        return ua.Variant(value, ua.VariantType.Boolean)
    if isinstance(value, str):
        return ua.Variant(value, ua.VariantType.String)
    if name in WHOLE and value is not None:
        return ua.Variant(value, ua.VariantType.Int64)
    return ua.Variant(math.nan if value is None else float(value), ua.VariantType.Double)


def data_value(name: str, value: Any, time_ns: int) -> ua.DataValue:
    # Whole microseconds, since a float of seconds would have fewer.
    written = datetime.datetime.fromtimestamp(time_ns // 10**9, datetime.timezone.utc)
    written += datetime.timedelta(microseconds=time_ns % 10**9 // 1000)
    unknown = ua.StatusCodes.BadNoDataAvailable
    return ua.DataValue(
        variant_of(name, value),
        ua.StatusCode(unknown if value is None else ua.StatusCodes.Good),
        SourceTimestamp=written,
    )


class OpcuaPlug(Plug):
    def __init__(self, settings: OpcuaSettings) -> None:
        super().__init__("opcua", max_rate_hz=1.0)
        self._settings = settings
        self._loop = asyncio.new_event_loop()
        self._loop_thread: threading.Thread | None = None
        self._server: Server | None = None
        self._index = 0
        self._variables: dict[tuple[str, ...], dict[str, Node]] = {}
        self._folders: dict[tuple[str, ...], Node] = {}
        self._values: dict[tuple[str, ...], tuple[Document, Members]] = {}
        self._beyond = 0

    def open(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._loop_thread = threading.Thread(
            target=self._loop.run_forever, name="opcua server", daemon=True
        )
        self._loop_thread.start()
        self._await(self._open(), OPEN_TIMEOUT_S)
        gc.freeze()  # what the server knows of OPC UA stays: to look through it would stop all
        self.log.info("listening on %s:%d", self._settings.listen.host, self._settings.listen.port)

    def close(self) -> None:
        if self._loop_thread is None:
            return
        try:
            if self._server:
                self._await(self._server.stop(), STOP_TIMEOUT_S)
        except (OSError, RuntimeError, TimeoutError, ua.UaError) as problem:
            self.log.warning("the server did not stop: %r", problem)
        self._server = None
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._loop_thread.join(1.0)
        self._loop_thread = None
        self._variables, self._folders = {}, {}

    def serve(self, item: Item) -> None:
        if isinstance(item, NewRun):
            self._await(self._age(item))
        elif not isinstance(item, ChannelSamples):
            self._await(self._write(item))

    def counts(self) -> dict[str, int]:
        return super().counts() | {"objects_left_out": self._beyond}

    def _await(self, coroutine: Any, timeout_s: float = SERVE_TIMEOUT_S) -> None:
        asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(timeout_s)

    async def _open(self) -> None:
        host, port = self._settings.listen.host, self._settings.listen.port
        server = Server(user_manager=Onlookers())
        await server.init()
        server.iserver.max_connections = self._settings.max_clients
        server.iserver.max_monitored_item_queue_size = 1000
        server.iserver.max_unacked_messages_per_subscription = 100
        shown = f"[{host}]" if ":" in host else host
        server.set_endpoint(f"opc.tcp://{shown}:{port}/dyncal")
        server.set_server_name("dyncal-bridge")
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        await server.set_application_uri(NAMESPACE)
        self._index = await server.register_namespace(NAMESPACE)
        root = await server.nodes.objects.add_object(
            ua.NodeId("dyncal", self._index), ua.QualifiedName("dyncal", self._index)
        )
        self._folders[()] = root
        try:
            await server.start()
        except OSError as problem:
            raise BridgeError(
                f"[opcua] cannot listen on {host}:{port}: {problem.strerror}; does another program "
                "have the port?"
            ) from None
        self._server = server
        for document, _ in list(self._values.values()):  # after a failure
            await self._write(document)

    async def _folder(self, path: tuple[str, ...]) -> Node:
        if path not in self._folders:
            parent = await self._folder(path[:-1])
            self._folders[path] = await parent.add_object(
                ua.NodeId("/".join(map(escaped, path)), self._index),
                ua.QualifiedName(path[-1], self._index),
            )
        return self._folders[path]

    async def _write(self, document: Document) -> None:
        # The last result of a channel, whatever its step.
        path = (document.bench, *path_of(document))
        path = path[:4] if document.kind == "point" else path
        variables = self._variables.get(path)
        if variables is None:
            if len(self._variables) >= MAX_OBJECTS:
                self._beyond += 1
                return
            await self._folder(path)
            variables = self._variables[path] = {}
        members = flat(document.members)
        before = self._values.get(path, (None, {}))[1]
        gone: Members = {name: "" if name in TEXTS else None for name in before}
        members = {**gone, **members} if gone else members
        self._values[path] = document, members
        for name, value in members.items():
            one = data_value(name, value, document.time_ns)
            if name in variables:
                await variables[name].write_value(one)
            else:
                variables[name] = await self._add_variable(path, name, one)

    async def _add_variable(self, path: tuple[str, ...], name: str, value: ua.DataValue) -> Node:
        folder = await self._folder(path)
        variable = await folder.add_variable(
            ua.NodeId("/".join(map(escaped, (*path, name))), self._index),
            ua.QualifiedName(name, self._index),
            value.Value.Value,
            value.Value.VariantType,
        )
        await variable.write_value(value)
        return variable

    async def _age(self, begun: NewRun) -> None:
        for path, (document, members) in self._values.items():
            is_result = document.kind in ("point", "transfer_function")
            if document.bench != begun.bench or not is_result or document.run == begun.run:
                continue
            for name, value in members.items():
                aged = data_value(name, value, document.time_ns)
                if value is not None:
                    uncertain = ua.StatusCodes.UncertainLastUsableValue
                    aged = ua.DataValue(
                        aged.Value, ua.StatusCode(uncertain), SourceTimestamp=aged.SourceTimestamp
                    )
                if name in self._variables.get(path, {}):
                    await self._variables[path][name].write_value(aged)
