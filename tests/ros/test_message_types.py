# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The name of a type comes from others on the network: only the messages of a package are imported for it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from rosidl_parser.definition import Array, BasicType, NamespacedType
from std_msgs.msg import String

from smarttestudo.domain.errors import RosError
from smarttestudo.robot.ros.message_types import is_installed, is_readable, message_type

pytestmark = pytest.mark.contract

HARMFUL = "from pathlib import Path\nPath({ran!r}).touch()\nclass Harm:\n    pass\n"
# Files of a package that is none of messages, or lacks what each such package has.
PACKAGES = {
    "a module": ["harmful.py"],
    "a package without messages": ["harmful/__init__.py"],
    "messages without compiled ones": [
        "harmful/__init__.py",
        "harmful/msg/__init__.py",
        "harmful/msg/_harm.py",
    ],
    "compiled messages of another package": [
        "harmful/__init__.py",
        "harmful/msg/__init__.py",
        "harmful/msg/_harm.py",
        "harmful/std_msgs_s__rosidl_typesupport_c.so",
    ],
    "messages that are one module": [
        "harmful/__init__.py",
        "harmful/msg.py",
        "harmful/harmful_s__rosidl_typesupport_c.so",
    ],
    "other messages": [
        "harmful/__init__.py",
        "harmful/msg/__init__.py",
        "harmful/msg/_good.py",
        "harmful/harmful_s__rosidl_typesupport_c.so",
    ],
    "a folder without a package": ["harmful/msg/__init__.py", "harmful/msg/_harm.py"],
}
NAMES = [
    *("this/msg/X", "antigravity/msg/X", "turtledemo/msg/X", "os/msg/path", "idlelib/msg/Idle"),
    *(
        "std_msgs/msg/builtins",
        "std_msgs/msg/Metaclass_String",
        "std_msgs/msg/__init__",
        "std_msgs/msg/nothing",
    ),
    *("std_srvs/srv/SetBool", "std_srvs/srv/Metaclass_SetBool_Event", "std_srvs/srv/SetBool_Goal"),
    *("std_srvs/msg/SetBool_Event", "std_msgs/srv/String_Event", "std_msgs/action/String_Feedback"),
    *("", "/", "//", "a/msg", "/msg/X", "a//X", "a/msg/", "a/msg/X/", "a/idl/X", "String", "std_msgs/String"),
    *("..", "../msg/X", "../../msg/../X", "std_msgs/../msg/String", "std_msgs/msg/../msg/String"),
    *("a.b/msg/X", ".std_msgs/msg/String", "std_msgs./msg/String", "os.path/msg/X", "std_msgs/msg.String"),
    *("class/msg/X", "import/msg/None", "std_msgs/msg/class", "None/msg/True", "__main__/msg/X", "_/msg/X"),
    *("std_msgs/msg/String\n", " std_msgs/msg/String", "std_msgs/msg/String\0", "std_msgs\\msg\\String"),
    *("std_msgs/msg/Strıng", "ſtd_msgs/msg/String", "éa/msg/X", "std_msgs/msg/ＸString", "٣/msg/X"),
    *("a" * 300 + "/msg/X", "std_msgs/msg/" + "X" * 300, "std_msgs/msg/" + "X" * 199, "a" * 1_000_000),
]


@pytest.mark.parametrize("files", PACKAGES.values(), ids=PACKAGES)
@pytest.mark.parametrize(
    "type_name", ["harmful/msg/Harm", "harmful/srv/Harm_Event", "harmful/action/Harm_Goal"]
)
def test_nothing_runs_of_a_module_that_is_no_package_of_messages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, files: list[str], type_name: str
) -> None:
    ran = tmp_path / "ran"
    for file in files:
        path = tmp_path / "modules" / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(HARMFUL.format(ran=str(ran)), "utf-8")
    monkeypatch.syspath_prepend(tmp_path / "modules")
    with pytest.raises(RosError, match="is not installed"):
        message_type(type_name, "/topic")
    assert not ran.exists()
    assert not [name for name in sys.modules if name.startswith("harmful")]


@pytest.mark.parametrize("type_name", NAMES, ids=range(len(NAMES)))
def test_a_name_that_is_none_of_an_installed_message_is_refused_and_imports_nothing(type_name: str) -> None:
    before = set(sys.modules)
    with pytest.raises(RosError, match=r"is not the name of a message type|is not installed") as raised:
        message_type(type_name, "/topic")
    assert len(str(raised.value)) < 1000
    assert not set(sys.modules) - before


@pytest.mark.parametrize(
    "type_name",
    [
        *(
            "std_msgs/msg/String",
            "std_msgs/msg/UInt8MultiArray",
            "nav_msgs/msg/Odometry",
            "sensor_msgs/msg/PointCloud2",
        ),
        *(
            "std_srvs/srv/SetBool_Request",
            "std_srvs/srv/SetBool_Response",
            "action_msgs/srv/CancelGoal_Request",
        ),
    ],
)
def test_messages_of_an_installed_package_are_found(type_name: str) -> None:
    assert is_installed(type_name)
    assert message_type(type_name, "/topic").__name__ == type_name.rpartition("/")[2]


@pytest.mark.parametrize("typename", ["long double", "wchar"])
def test_what_rosidl_cannot_convert_for_python_is_never_decoded(typename: str) -> None:
    class Alone:
        SLOT_TYPES = (BasicType("int32"), BasicType(typename))

    class Several:
        SLOT_TYPES = (NamespacedType(["std_msgs", "msg"], "String"), Array(BasicType(typename), 3))

    assert [is_readable(kind) for kind in (Alone, Several, String)] == [False, False, True]
