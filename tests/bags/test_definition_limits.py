# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A definition for which rosbags would write code for minutes is refused before; usual ones are read."""

from __future__ import annotations

import pytest
from rosbags.typesys import get_types_from_msg

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.readable_types import (
    MAX_STATEMENTS,
    MAX_VALUES,
    require_few_statements,
    require_few_values,
)
from smarttestudo.domain.recording import Channel

SEPARATOR = "=" * 80 + "\n"
TYPE = "robot_msgs/msg/Large"
IDL = (
    f"{SEPARATOR}IDL: {TYPE}\n"
    "module robot_msgs {{ module msg {{ {0} struct Large {{ {1} double x; }}; }}; }};"
)


def nested(levels: int) -> str:
    """A type of eight fields, of types of eight fields, and so on."""
    fields = "".join(f"Level{{}} field_{number}\n" for number in range(8))
    parts = [
        f"MSG: robot_msgs/Level{level}\n" + fields.replace("{}", str(level + 1)) for level in range(levels)
    ]
    last = f"MSG: robot_msgs/Level{levels}\nfloat64 x\n"
    return SEPARATOR.join([fields.replace("{}", "0"), *parts, last])


REFUSED = {
    "fields": "".join(f"float64 field_{number}\n" for number in range(MAX_STATEMENTS + 1)),
    "constants": "".join(f"int32 C{number}={number}\n" for number in range(MAX_STATEMENTS + 1)),
    "texts": "string[1000000000] texts\n",
    "arrays": f"Part[1000000000] parts\n{SEPARATOR}MSG: robot_msgs/Part\nfloat64 x\n",
    "nested": nested(30),
    "itself": "robot_msgs/Large[2] parts\n",
    "IDL fields": IDL.format("", "".join(f"double f{number};" for number in range(MAX_STATEMENTS + 1))),
    "IDL annotations": IDL.format("", "@x " * (MAX_STATEMENTS + 1)),
    "IDL parentheses": IDL.format(f"const long X = {'(' * 30}1{')' * 30};", ""),
    "IDL sequences": IDL.format("", f"{'sequence<' * 40}double{'>' * 40} nested;"),
}
READ = {
    "numbers": "float64[100000000] numbers\nuint8[] data\n",
    "fields": "".join(f"# About {number}\nfloat64 field_{number}\n" for number in range(300)),
    "comments": "# Much is said.\n" * 20_000 + "float64 x\n",
    "nested": nested(2),
    "texts": "string[20] texts\nPart[30] parts\n" + f"{SEPARATOR}MSG: robot_msgs/Part\nstring[3] names\n",
    "IDL": IDL.format("const long X = (1);", '@verbatim (language="comment", text="(((so)))")'),
}


def can_decode(definition: str) -> bool:
    channel = Channel(topic="/a", type_name=TYPE, definition=definition, serialization_format="cdr")
    return RosbagDecoder().why_undecodable(channel) is None


@pytest.mark.parametrize("definition", REFUSED.values(), ids=REFUSED)
def test_a_definition_beyond_the_limits_is_not_understood(definition: str) -> None:
    assert not can_decode(definition)


@pytest.mark.parametrize("definition", READ.values(), ids=READ)
def test_a_definition_within_them_is_read(definition: str) -> None:
    assert can_decode(definition)


def test_each_limit_is_said() -> None:
    with pytest.raises(ValueError, match="more than 5 000 statements"):
        require_few_statements(REFUSED["fields"], is_idl=False)
    with pytest.raises(ValueError, match="more than 5 000 values"):
        require_few_values(get_types_from_msg(f"string[{MAX_VALUES + 1}] texts\n", TYPE), TYPE)
