# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of any type are read from their bytes by the definition beside them, as a robot reads them."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from smarttestudo.bags.definition_text import SEPARATOR
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.recording import Channel
from smarttestudo.language.properties import part_reader

ACTION = "int32 order\n---\nint32[] sequence\n---\nint32[] partial\n"
SERVICE = "int64 a\nint64 b\n---\nint64 sum\n"
GID = bytes(range(16))


class Cdr:
    """Bytes of a message, each number or text at its place; ``end`` is < or >."""

    def __init__(self, end: str = "<") -> None:
        self.end = end
        self.content = b""

    def put(self, form: str, *values: Any) -> Cdr:
        for value in values:
            data = struct.pack(self.end + form, value)
            self.content += bytes(-len(self.content) % len(data)) + data
        return self

    def text(self, text: str, encoding: str = "utf-8") -> Cdr:
        data = text.encode(encoding) + b"\0"
        self.put("I", len(data)).content += data
        return self

    def wide(self, text: str, unit: str) -> Cdr:
        units = [code for (code,) in struct.iter_unpack("<H", text.encode("utf-16-le"))]
        return self.put("I", len(units)).put(unit, *units)

    def stamp(self) -> Cdr:
        return self.put("i", 7).put("I", 8)

    @property
    def payload(self) -> bytes:
        return (b"\0\1" if self.end == "<" else b"\0\0") + b"\0\0" + self.content


def values(type_name: str, definition: str, payload: bytes, *paths: str) -> list[Any]:
    """What rules read: a number or a text, ``None`` where it is unknown."""
    decoder, channel = RosbagDecoder(), Channel(topic="/t", type_name=type_name, definition=definition)
    assert decoder.why_undecodable(channel) is None
    message = decoder.decode(channel, payload)
    return [part_reader(path)(message) for path in paths]


def of_msg(*fields: str) -> str:
    return "\n".join(fields) + "\n"


def of_idl(*fields: str, kind: str = "msg", name: str = "M", include: str = "") -> str:
    struct_text = f"struct {name} {{ {' '.join(fields)} }};"
    text = f"// generated\n{include}\nmodule p {{ module {kind} {{\n{struct_text}\n}}; }};\n"
    return f"{SEPARATOR}IDL: p/{kind}/{name}\n{text}"


@pytest.mark.parametrize("end", ["<", ">"], ids=["little endian", "big endian"])
def test_bytes_and_characters_are_what_they_are_on_a_robot(end: str) -> None:
    msg = of_msg(
        "byte one", "byte[2] two", "byte[] more", "char letter", "int8 small", "bool on", "float64 last"
    )
    cdr = (
        Cdr(end)
        .put("B", 200, 201, 202)
        .put("I", 2)
        .put("B", 203, 255, 65)
        .put("b", -1)
        .put("B", 1)
        .put("d", 2.5)
    )
    paths = ("one", "two[1]", "more[0]", "more[1]", "more[2]", "letter", "small", "on", "last")
    assert values("p/msg/M", msg, cdr.payload, *paths) == [200, 202, 203, 255, None, 65, -1, 1, 2.5]
    idl = of_idl(
        *(
            "octet one;",
            "octet two[2];",
            "sequence<octet> more;",
            "char letter;",
            "int8 small;",
            "boolean on;",
        ),
        "double last;",
    )
    idl = idl.replace("octet two[2]", "octet__2 two").replace(
        "struct M", "typedef octet octet__2[2]; struct M"
    )
    assert values("p/msg/M", idl, cdr.payload, *paths) == [200, 202, 203, 255, None, "A", -1, 1, 2.5]


@pytest.mark.parametrize("end", ["<", ">"], ids=["little endian", "big endian"])
@pytest.mark.parametrize("unit", ["I", "H"], ids=["four bytes a character", "two bytes a character"])
@pytest.mark.parametrize("text", ["", "ab", "Hellö", "ハロー", "a😀"])
def test_wide_texts_are_read_however_long_their_characters_are(unit: str, text: str, end: str) -> None:
    cdr = Cdr(end).wide(text, unit).put("I", 2).wide("x", unit).wide(text, unit).put("d", 4.5).put("B", 9)
    msg = of_msg('wstring name "Hellö wörld"', "wstring<=30[<=3] names", "float64 level", "byte last")
    msg = 'wstring DEFAULT = "ä"\n' + msg
    idl = of_idl("wstring name;", "sequence<wstring<30>, 3> names;", "double level;", "octet last;")
    for definition in (msg, idl):
        read = values("p/msg/M", definition, cdr.payload, "name", "names[0]", "names[1]", "level", "last")
        assert read == [text, "x", text, 4.5, 9]


@pytest.mark.parametrize("unit", ["H", "I"], ids=["Fast CDR 2", "Fast CDR 1"])
def test_a_wide_character_is_read(unit: str) -> None:
    cdr = Cdr().put(unit, ord("ö")).put("d", 1.5)
    assert values("p/msg/M", of_idl("wchar one;", "double level;"), cdr.payload, "one", "level") == ["ö", 1.5]


def test_a_long_double_is_unknown_and_the_fields_around_it_are_not() -> None:
    definition = of_idl("long before;", "long double exact;", "sequence<long double> more;", "double after;")
    cdr = Cdr().put("i", 3)
    cdr.content += bytes(4) + bytes(range(16))
    cdr.put("I", 1)
    cdr.content += bytes(4) + bytes(16)
    cdr.put("d", 6.5)
    paths = ("before", "exact", "more[0]", "after")
    assert values("p/msg/M", definition, cdr.payload, *paths) == [3, None, None, 6.5]
    channel = Channel(topic="/t", type_name="p/msg/M", definition=definition)
    assert list(RosbagDecoder().unread(channel)) == ["exact", "more"]


def test_a_definition_that_includes_others_is_read() -> None:
    header = (
        f"{SEPARATOR}IDL: p/msg/H\nmodule p {{ module msg {{ struct H {{ unsigned short number; }}; }}; }};\n"
    )
    definition = of_idl("p::msg::H head;", "double level;", include='#include "p/msg/H.idl"\n') + header
    assert values("p/msg/M", definition, Cdr().put("H", 5).put("d", 1.5).payload, "head.number", "level") == [
        5,
        1.5,
    ]


def test_a_text_of_another_encoding_costs_its_strange_characters_only() -> None:
    cdr = Cdr().text("Café", "latin-1").put("d", 1.5)
    assert values("p/msg/M", of_msg("string name", "float64 level"), cdr.payload, "name", "level") == [
        "Caf\ufffd",
        1.5,
    ]


def test_bytes_behind_the_message_which_rclpy_leaves_there_mean_nothing() -> None:
    cdr = Cdr().put("I", 0, 0).put("i", 77)
    definition = of_msg("float64[] effort", "float64[] velocity", "int32 last")
    assert values("p/msg/M", definition, cdr.payload + bytes(range(8)), "last", "effort[0]") == [77, None]


def service_event(*, request: tuple[int, int] | None, response: int | None) -> bytes:
    cdr = Cdr().put("B", 1).stamp().put("B", *GID).put("q", 12)
    cdr.put("I", request is not None)
    cdr.put("q", *(request or ()))
    cdr.put("I", response is not None)
    return cdr.put("q", *([] if response is None else [response])).payload


DEFINITIONS_OF_EVENTS = {
    "the file alone": SERVICE,
    "the file with Windows' line ends": SERVICE.replace("\n", "\r\n"),
    "the file with its name, as rosbag2 stores it": f"{SEPARATOR}SRV: p/srv/Add\n{SERVICE}",
    "the file and types within": f"{SEPARATOR}SRV: p/srv/Add\n{SERVICE}\n{SEPARATOR}MSG: q/Point\nint8 x\n",
    "the message that it is": "service_msgs/ServiceEventInfo info\np/Add_Request[<=1] request\n"
    f"p/Add_Response[<=1] response\n{SEPARATOR}MSG: p/Add_Request\nint64 a\nint64 b\n"
    f"{SEPARATOR}MSG: p/Add_Response\nint64 sum\n",
    "the message with names of three parts": "service_msgs/msg/ServiceEventInfo info\n"
    "p/srv/Add_Request[<=1] request\np/srv/Add_Response[<=1] response\n"
    f"{SEPARATOR}MSG: p/srv/Add_Request\nint64 a\nint64 b\n{SEPARATOR}MSG: p/srv/Add_Response\nint64 sum\n",
    "IDL": f"{SEPARATOR}IDL: p/srv/Add\nmodule p {{ module srv {{ struct Add_Request {{ int64 a, b; }};\n"
    "struct Add_Response { int64 sum; }; }; };\n",
}


@pytest.mark.parametrize("definition", DEFINITIONS_OF_EVENTS.values(), ids=DEFINITIONS_OF_EVENTS)
def test_the_events_of_a_service_are_read_whatever_describes_them(definition: str) -> None:
    paths = ("info.event_type", "info.stamp.sec", "info.sequence_number", "request[0].b", "response[0].sum")
    for request, response, expected in (
        ((4, 5), None, [5, None]),
        (None, 9, [None, 9]),
        (None, None, [None, None]),
    ):
        payload = service_event(request=request, response=response)
        assert values("p/srv/Add_Event", definition, payload, *paths) == [1, 7, 12, *expected]


@pytest.mark.parametrize(
    ("name", "payload", "path", "value"),
    [
        (
            "Go_FeedbackMessage",
            Cdr().put("B", *GID).put("I", 2).put("i", 8, 9).payload,
            "feedback.partial[1]",
            9,
        ),
        ("Go_SendGoal_Request", Cdr().put("B", *GID).put("i", 4).payload, "goal.order", 4),
        ("Go_SendGoal_Response", Cdr().put("B", 1).stamp().payload, "accepted", True),
        ("Go_GetResult_Request", Cdr().put("B", *GID).payload, "goal_id.uuid[3]", 3),
        ("Go_GetResult_Response", Cdr().put("b", 4).put("I", 1).put("i", 6).payload, "result.sequence[0]", 6),
        ("Go_Feedback", Cdr().put("I", 1).put("i", 6).payload, "partial[0]", 6),
    ],
)
@pytest.mark.parametrize("before", ["", f"{SEPARATOR}ACTION: p/action/Go\n"])
def test_the_messages_of_an_action_are_read(
    name: str, payload: bytes, path: str, value: object, before: str
) -> None:
    assert values(f"p/action/{name}", before + ACTION, payload, path) == [value]


@pytest.mark.parametrize(
    "type_name", ["p/srv/Other_Event", "p/srv/Add", "p/action/Add_FeedbackMessage", "p/msg/Add_Event"]
)
def test_what_a_file_does_not_describe_is_not_read(type_name: str) -> None:
    definition = (
        f"{SEPARATOR}IDL: p/srv/Add\nmodule p {{ module srv {{ struct Add_Request {{ int64 a; }}; }}; }};\n"
    )
    assert RosbagDecoder().why_undecodable(Channel(topic="/t", type_name=type_name, definition=definition))
