# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Definitions are understood as tools write them, and where one is not, a reason says why."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from bags.bag_factory import START_NS
from smarttestudo.bags.definition_text import SEPARATOR, sections, stored_definition
from smarttestudo.bags.definitions import RosbagDecoder, TypeLibrary, msg_fields
from smarttestudo.bags.measure import measure_bag, measure_run
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.names import ros_type_name
from smarttestudo.domain.recording import Channel, ForeignSchema, Storage

NAME = "demo/msg/Level"
HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
TIME = "int32 sec\nuint32 nanosec\n"
SHORT_SEPARATOR = "=" * 40 + "\n"
OTHER = f"{SEPARATOR}MSG: demo/Other\nint8 x\n"
OTHER_IDL = "module demo { module msg { struct Other { int8 x; }; }; };\n"
STRUCT = "struct Level { float level; };"
IDL = f"// generated\n#include <x.idl>\nmodule demo {{ module msg {{\n{STRUCT}\n}}; }};\n"
FORMS = {
    "plain": "float32 level\n",
    "no line end": "float32 level",
    "Windows": "# made there\r\nfloat32 level\r\n",
    "old Macintosh": "# made there\rfloat32 level\r",
    "mark of the byte order": "\ufefffloat32 level\n",
    "such a mark in each part": f"\ufefffloat32 level\n{SEPARATOR}MSG: demo/Other\n\ufeffint8 x\n",
    "zeros at the end": "float32 level\n\0\0",
    "tabs": "\tfloat32\tlevel\t# of it\n",
    "default": "float32 level 1.5\n",
    "odd defaults": "float32 level .5f\n",
    "default without a value": "float32 level  \n",
    "default of a text": "float32 level what ever = # \u00e4\n",
    "constants": "uint8 A=1\nuint8 B = 2 # b\nuint8 low=3\nstring NO=\nstring Q=\"'#=\nfloat32 level\n",
    "odd constants": "float64 N=nan\nbool ON=maybe\nint8 LARGE=0x1FF\nwstring W=\u00e4\nfloat32 level\n",
    "constants of types that are none": "float32 level\ndemo/Nothing X=1\n",
    "include": '#include "demo/Other.msg"\nfloat32 level\n',
    "annotation": "@key\nfloat32 level\n",
    "annotation before the field": "@optional float32 level\n",
    "part without a line end": f"float32 level\n{OTHER.rstrip()}",
    "parts twice": f"float32 level\n{OTHER}{OTHER}",
    "lines below a short ruler": f"float32 level\n{SHORT_SEPARATOR}MSG: demo/Other\nint8 x\n",
    "blanks in headers": f"float32 level\n{'=' * 80}  \n MSG:demo/Other \nint8 x\n",
    "ruler at the end": f"float32 level\n{SEPARATOR}",
    "its own header": f"{SEPARATOR}MSG: {NAME}\nfloat32 level\n",
    "a short header of its own": f"{SEPARATOR}MSG: demo/Level\nfloat32 level\n",
    "another name in its header": f"{SEPARATOR}MSG: old/Name\nfloat32 level\n{OTHER}",
    "a part of ROS 2 that makes no sense": "float32 level\nstd_msgs/Header header\n"
    f"{SEPARATOR}MSG: std_msgs/Header\n???\n",
    "parts of ROS 2 left out": "float32 level\nstd_msgs/Header header\ngeometry_msgs/Pose pose\n",
    "comment like a header": "# ====\n# MSG: nothing\nfloat32 level\n",
    "IDL": IDL,
    "IDL with its header": f"{SEPARATOR}IDL: {NAME}\n{IDL}",
    "IDL of Windows": IDL.replace("\n", "\r\n"),
    "IDL with a mark of the byte order": f"\ufeff{IDL}",
    "IDL and .msg": f"{SEPARATOR}IDL: {NAME}\n{IDL}{OTHER}",
    ".msg and IDL": f"float32 level\ndemo/Other other\n{SEPARATOR}IDL: demo/msg/Other\n{OTHER_IDL}",
    ".msg with its header and IDL": f"{SEPARATOR}MSG: {NAME}\nfloat32 level\n"
    f"{SEPARATOR}IDL: demo/msg/Other\n{OTHER_IDL}",
    "IDL called .msg": f"float32 level\n{SEPARATOR}MSG: demo/msg/Other\n{OTHER_IDL}",
}
PAYLOAD = b"\0\1\0\0" + struct.pack("<fqI", 0.5, 0, 1) + bytes(100)


def channel_of(text: str, encoding: str = "ros2msg", name: str = NAME) -> Channel:
    definition, foreign = stored_definition(name, encoding, text.encode())
    return Channel(topic="/x", type_name=name, definition=definition, foreign_schema=foreign)


@pytest.mark.parametrize("text", FORMS.values(), ids=FORMS)
def test_a_field_is_read_whatever_stands_around_it(text: str) -> None:
    decoder, channel = RosbagDecoder(), channel_of(text)
    assert decoder.why_undecodable(channel) is None
    assert decoder.decode(channel, PAYLOAD).level == 0.5  # type: ignore[attr-defined]


NOISE = st.lists(
    st.sampled_from(["# \u00e4 = b", "", "  ", "uint8 A=1", 'string B="#"', "string C=", "wstring D=\u00e4"]),
    max_size=3,
)
FIELD_TYPES = st.sampled_from(
    [
        "bool",
        "byte",
        "char",
        "int8",
        "uint64",
        "float32",
        "string",
        "string<=9",
        "wstring",
        "wstring<=3",
        "int8[]",
        "float64[3]",
        "string<=2[<=4]",
        "Other",
        "demo/Other[2]",
        "demo/msg/Other[<=7]",
        "std_msgs/Header",
    ]
)
AFTER = st.sampled_from(["", " 1", ' "x = 1"', " # c", "\t[1, 2]"])


@given(
    st.lists(st.tuples(FIELD_TYPES, NOISE, AFTER), max_size=9),
    st.sampled_from(["\n", "\r\n", "\r"]),
    st.sampled_from([" ", "\t", "   "]),
)
def test_fields_are_the_same_with_anything_that_may_stand_beside_them(
    fields: list[tuple[str, list[str], str]], line_end: str, gap: str
) -> None:
    lines, plain = [], []
    for number, (kind, noise, after) in enumerate(fields):
        lines += [*noise, f"{gap}{kind}{gap}f{number}{after}"]
        plain.append(f"{kind} f{number}")
    (noisy,) = sections("\ufeff" + line_end.join(lines), NAME)
    (clean,) = sections("\n".join(plain), NAME)
    assert msg_fields(noisy, "demo", "msg") == msg_fields(clean, "demo", "msg")


def test_all_types_of_ros_2_are_read_as_rosbags_reads_them() -> None:
    store = get_typestore(Stores.ROS2_KILTED)
    for name in store.fielddefs:
        text, _ = store.generate_msgdef(name, ros_version=2)
        expected = get_types_from_msg(text, name)
        own = {
            part.name.replace("/msg/", "/"): msg_fields(part, part.name.partition("/")[0], "msg")
            for part in sections(text, name)
        }
        assert own == {one.replace("/msg/", "/"): fields for one, (_, fields) in expected.items()}


UNDEFINED = f"neither the recording nor ROS 2 defines {NAME}"
REASONS = {
    "no definition": (channel_of(""), f"neither the recording nor ROS 2 defines {NAME}"),
    "blanks": (channel_of(" \n"), f"neither the recording nor ROS 2 defines {NAME}"),
    "not found by the recorder": (
        channel_of("", "unknown"),
        f"neither the recording nor ROS 2 defines {NAME}",
    ),
    "no field": (
        channel_of("int8 a\n\nfloat32 level,\n"),
        f"its definition of {NAME} is not understood: line 3: 'float32 level,' is no field",
    ),
    "no field in a part": (
        channel_of(f"demo/Other a\n{SEPARATOR}MSG: demo/Other\nint8\n"),
        f"its definition of {NAME} is not understood: line 4: 'int8' is no field",
    ),
    "a field twice": (
        channel_of("int8 a\nint8 a\n"),
        f"its definition of {NAME} is not understood: line 2: a second field a",
    ),
    "a type that is nowhere": (
        channel_of("Nothing a\n"),
        f"its definition of {NAME} is not understood: it does not define demo/msg/Nothing",
    ),
    "a type within itself": (
        channel_of(f"Other a\n{SEPARATOR}MSG: demo/Other\nLevel[] b\n"),
        f"its definition of {NAME} is not understood: its types nest without end, or beyond 64",
    ),
    "no IDL": (
        channel_of("module demo { struct", "ros2idl"),
        f"its definition of {NAME} is not understood: the text from line 3 on is no IDL that ROS 2 has",
    ),
    "another language": (
        channel_of("{}", "jsonschema"),
        f"its type {NAME} is defined in jsonschema, not by ROS 2",
    ),
    "JSON": (
        Channel(topic="/x", type_name="gps", serialization_format="json"),
        "recorded as json, not as cdr",
    ),
    "ROS 1": (
        Channel(topic="/x", type_name="std_msgs/msg/Float64", serialization_format="ros1"),
        "recorded as ros1, not as cdr",
    ),
    "nothing said": (
        Channel(topic="/x", type_name="std_msgs/msg/Float64", serialization_format=""),
        "recorded as no known format, not as cdr",
    ),
    "no type": (Channel(topic="/x", type_name=""), "recorded without a type"),
}


@pytest.mark.parametrize(("channel", "why"), REASONS.values(), ids=REASONS)
def test_a_reason_says_why_a_channel_cannot_be_decoded(channel: Channel, why: str) -> None:
    assert TypeLibrary().why_undecodable(channel) == why
    assert TypeLibrary().readable(channel) is None


@pytest.mark.parametrize("text", ["???", "std_msgs/Nothing x", "\x01\x02", f"{SEPARATOR}IDL: a\nmodule"])
def test_a_standard_type_whose_definition_makes_no_sense_is_that_of_ros_2(text: str) -> None:
    channel = channel_of(text, name="std_msgs/msg/Float32")
    assert RosbagDecoder().decode(channel, PAYLOAD[:8]).data == 0.5  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("nav_msgs/msg/Odometry", "nav_msgs/msg/Odometry"),
        ("nav_msgs/Odometry", "nav_msgs/msg/Odometry"),
        ("nav_msgs::msg::Odometry", "nav_msgs/msg/Odometry"),
        ("nav_msgs::msg::dds_::Odometry_", "nav_msgs/msg/Odometry"),
        ("nav_msgs/msg/dds_/Odometry_", "nav_msgs/msg/Odometry"),
        ("std_srvs::srv::dds_::SetBool_Request_", "std_srvs/srv/SetBool_Request"),
        ("std_srvs/SetBool_Event", "std_srvs/srv/SetBool_Event"),
        ("p/Go_FeedbackMessage", "p/action/Go_FeedbackMessage"),
        ("p/Go_SendGoal_Request", "p/action/Go_SendGoal_Request"),
        ("foxglove.SceneUpdate", "foxglove.SceneUpdate"),
        ("gps", "gps"),
        ("a/b/c/d", "a/b/c/d"),
        ("", ""),
        ("/", "/"),
        ("::", "::"),
    ],
)
def test_type_names_are_those_of_ros_2_whatever_a_tool_calls_them(text: str, name: str) -> None:
    assert ros_type_name(text, "cdr") == name
    assert ros_type_name(text, "ros1") == text


@pytest.mark.parametrize("storage", Storage)
def test_what_is_not_decoded_is_written_with_its_schema(storage: Storage, tmp_path: Path) -> None:
    schemas = {
        "/gps": ("gps", "json", ForeignSchema(encoding="jsonschema", data=b'{"type": "object"}')),
        "/objects": ("foxglove.Scene", "protobuf", ForeignSchema(encoding="protobuf", data=b"\n\x10\xff")),
        "/pose": ("std_msgs/msg/Int8", "ros1", ForeignSchema(encoding="ros1msg", data=b"int8 data\n")),
        "/odd": ("p/msg/Odd", "cdr", ForeignSchema(encoding="omg", data=b"")),
    }
    with create_recording(tmp_path / "bag", storage=storage) as writer:
        for topic, (name, form, schema) in schemas.items():
            channel = Channel(topic=topic, type_name=name, serialization_format=form, foreign_schema=schema)
            writer.write(channel, START_NS, b"{}")
    with open_recording(tmp_path / "bag") as recording:
        read = {
            one.topic: (one.type_name, one.serialization_format, one.foreign_schema)
            for one in recording.channels
        }
        assert read == schemas
        assert len([*recording.messages()]) == 4


def test_the_reasons_are_told_with_the_numbers(tmp_path: Path) -> None:
    path = tmp_path / "mixed.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="test")
        for topic, name, encoding, text, form in (
            ("/gps", "gps", "jsonschema", b"{}", "json"),
            ("/odd", "p/msg/Odd", "ros2msg", b"int8 a\nint8\n", "cdr"),
            ("/level", "p/msg/Level", "ros2msg", b"\xef\xbb\xbfint8 a\r\n", "cdr"),
            ("/data", "std_msgs::msg::dds_::Int8_", "ros2msg", b"int8 data\n", "cdr"),
        ):
            channel = writer.register_channel(topic, form, writer.register_schema(name, encoding, text))
            for at in range(3):
                writer.add_message(channel, START_NS + at, b"\0\1\0\0\5", START_NS + at)
        writer.finish()  # type: ignore[no-untyped-call]
    told = (
        "/gps: recorded as json, not as cdr; its messages are counted, but cannot be decoded",
        "/odd: its definition of p/msg/Odd is not understood: line 2: 'int8' is no field; "
        "its messages are counted, but cannot be decoded",
    )
    assert measure_bag(path, lambda _: None).notices == told
    assert measure_run(path, lambda _: None).summary.notices == told
    with open_recording(path) as recording:
        types: Mapping[str, str] = {one.topic: one.type_name for one in recording.channels}
    assert types["/data"] == "std_msgs/msg/Int8"


def test_an_enum_of_idl_is_its_number() -> None:
    text = (
        f"{SEPARATOR}IDL: {NAME}\nmodule demo {{ module msg {{ enum Mode {{ OFF, ON }}; "
        "struct Level { Mode mode; sequence<Mode> more; }; }; };\n"
    )
    channel = Channel(topic="/level", type_name=NAME, definition=text)
    message: Any = RosbagDecoder().decode(channel, b"\0\1\0\0" + struct.pack("<IIII", 1, 2, 0, 7))
    assert (message.mode, [*message.more]) == (1, [0, 7])
