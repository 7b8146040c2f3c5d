"""The settings file: which plugs there are, and how. Off unless its table is there.

    benches = ["acc-1"]              # default: all
    [foxglove]
    listen = "127.0.0.1:8765"
    [mqtt]
    broker = "127.0.0.1:1883"
    [opcua]
    listen = "127.0.0.1:4840"

Every key is in deploy/guide/live-views.md. An unknown key, a value of another type or outside its
range is refused with a sentence that names file and key.
"""

from __future__ import annotations

import dataclasses
import math
import pathlib
import re
import tomllib
from typing import Any

from dyncal_bridge.document import BridgeError

MAX_BENCH_BYTES = 64
ADDRESS = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[^\[\]:\s]+):(\d{1,5})")
TOPIC = re.compile(r"[^+#/$\x00-\x1f][^+#\x00-\x1f]*")


@dataclasses.dataclass(frozen=True)
class Address:
    host: str
    port: int


@dataclasses.dataclass(frozen=True)
class FoxgloveSettings:
    listen: Address
    max_rate_hz: float
    tls_certificate: pathlib.Path | None
    tls_key: pathlib.Path | None


@dataclasses.dataclass(frozen=True)
class MqttSettings:
    broker: Address
    topic: str
    samples: tuple[str, ...]
    max_rate_hz: float
    user: str
    password_file: pathlib.Path | None
    tls_ca: pathlib.Path | None
    tls_certificate: pathlib.Path | None
    tls_key: pathlib.Path | None


@dataclasses.dataclass(frozen=True)
class OpcuaSettings:
    listen: Address
    max_clients: int


@dataclasses.dataclass(frozen=True)
class Settings:
    benches: tuple[str, ...]
    foxglove: FoxgloveSettings | None
    mqtt: MqttSettings | None
    opcua: OpcuaSettings | None


class Table:
    """A table of the file, whose keys are taken one by one; what is left at the end is unknown."""

    def __init__(self, file: pathlib.Path, name: str, content: dict[str, Any]) -> None:
        self._file, self._name, self._rest = file, name, dict(content)
        self._known: list[str] = []

    def refuse(self, key: str, why: str) -> BridgeError:
        place = f"{self._name}.{key}" if self._name else key
        return BridgeError(f"{self._file}: {place}: {why}")

    def take(self, key: str, default: Any) -> Any:
        self._known.append(key)
        return self._rest.pop(key, default)

    def table(self, key: str) -> Table | None:
        content = self.take(key, None)
        if content is None:
            return None
        if not isinstance(content, dict):
            raise self.refuse(key, f"is {content!r}, not a table [{key}]")
        return Table(self._file, key, content)

    def text(self, key: str, default: str) -> str:
        value = self.take(key, default)
        if not isinstance(value, str):
            raise self.refuse(key, f"is {value!r}, not a text")
        return value

    def texts(self, key: str) -> tuple[str, ...]:
        value = self.take(key, [])
        if not isinstance(value, list) or not all(isinstance(one, str) and one for one in value):
            raise self.refuse(key, f"is {value!r}, not a list of texts")
        return tuple(value)

    def address(self, key: str, default: str) -> Address:
        value = self.text(key, default)
        found = ADDRESS.fullmatch(value)
        if not found or not 0 < int(found[2]) < 65536:
            raise self.refuse(key, f"is '{value}', not an address and a port as in {default}")
        return Address(found[1].strip("[]"), int(found[2]))

    def rate(self, key: str, default: float, most: float) -> float:
        value = self.take(key, default)
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value) or not 0.001 <= value <= most:
            raise self.refuse(key, f"is {value!r}, not a rate from 0.001 to {most:g} Hz")
        return float(value)

    def whole(self, key: str, default: int, most: int) -> int:
        value = self.take(key, default)
        if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= most:
            raise self.refuse(key, f"is {value!r}, not a whole number from 1 to {most}")
        return value

    def file(self, key: str) -> pathlib.Path | None:
        """Of a file that can be read; relative to the settings file."""
        value = self.text(key, "")
        if not value:
            return None
        path = self._file.parent / value
        try:
            with path.open("rb"):
                return path
        except OSError as problem:
            raise self.refuse(key, f"{path} cannot be read: {problem.strerror}") from None

    def end(self) -> None:
        for key in self._rest:
            raise self.refuse(key, f"there is no such key; there are {', '.join(self._known)}")


def together(
    table: Table, certificate: pathlib.Path | None, key: pathlib.Path | None
) -> None:
    if (certificate is None) != (key is None):
        there, missing = ("tls_certificate", "tls_key") if certificate else (
            "tls_key", "tls_certificate")
        raise table.refuse(there, f"needs {missing} as well: a certificate and its key")


def foxglove_settings(table: Table) -> FoxgloveSettings:
    settings = FoxgloveSettings(
        table.address("listen", "127.0.0.1:8765"),
        table.rate("max_rate_hz", 500.0, 100_000.0),
        table.file("tls_certificate"),
        table.file("tls_key"),
    )
    table.end()
    together(table, settings.tls_certificate, settings.tls_key)
    return settings


def mqtt_settings(table: Table) -> MqttSettings:
    settings = MqttSettings(
        table.address("broker", "127.0.0.1:1883"),
        table.text("topic", "dyncal"),
        table.texts("samples"),
        table.rate("max_rate_hz", 10.0, 10_000.0),
        table.text("user", ""),
        table.file("password_file"),
        table.file("tls_ca"),
        table.file("tls_certificate"),
        table.file("tls_key"),
    )
    table.end()
    if not TOPIC.fullmatch(settings.topic) or settings.topic.endswith("/"):
        raise table.refuse(
            "topic", f"is '{settings.topic}', but no topic may begin or end with / or have + or #"
        )
    for one in settings.samples:
        if one.count("/") < 2:
            raise table.refuse(
                "samples", f"'{one}' is not BENCH/SOURCE/CHANNEL, each of which may be *"
            )
    together(table, settings.tls_certificate, settings.tls_key)
    if settings.tls_certificate and not settings.tls_ca:
        raise table.refuse("tls_certificate", "needs tls_ca as well: who has signed the broker's")
    if settings.password_file and not settings.user:
        raise table.refuse("password_file", "needs user as well: whose password it is")
    return settings


def opcua_settings(table: Table) -> OpcuaSettings:
    settings = OpcuaSettings(
        table.address("listen", "127.0.0.1:4840"), table.whole("max_clients", 20, 1000)
    )
    table.end()
    return settings


def bench_names(whole: Table) -> tuple[str, ...]:
    names = whole.texts("benches")
    for name in names:
        if len(name.encode()) > MAX_BENCH_BYTES or set(name) & set("*?[]"):
            raise whole.refuse(
                "benches", f"'{name}' is no name of a bench: at most 64 bytes, none of * ? [ ]"
            )
    return names


def read_settings(file: pathlib.Path) -> Settings:
    """Raises BridgeError: what is wrong, and where."""
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as problem:
        raise BridgeError(f"{file}: cannot be read: {problem.strerror}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise BridgeError(f"{file}: is not TOML: {problem}") from None
    whole = Table(file, "", content)
    benches = bench_names(whole)
    foxglove, mqtt, opcua = (whole.table(name) for name in ("foxglove", "mqtt", "opcua"))
    whole.end()
    if not (foxglove or mqtt or opcua):
        raise BridgeError(
            f"{file}: has none of the tables [foxglove], [mqtt] and [opcua], so there is nothing "
            "to hand on to; an empty table takes the defaults"
        )
    return Settings(
        benches,
        foxglove_settings(foxglove) if foxglove else None,
        mqtt_settings(mqtt) if mqtt else None,
        opcua_settings(opcua) if opcua else None,
    )
