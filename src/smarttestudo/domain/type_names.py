# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of message types, those of services and actions among them."""

from __future__ import annotations

import re
from dataclasses import dataclass

_NAME = r"[A-Za-z]\w{0,199}"
_OF_SERVICE = r"_(?:Request|Response|Event)"
_OF_ACTION = rf"_(?:Goal|Result|Feedback|FeedbackMessage|(?:SendGoal|GetResult){_OF_SERVICE})"
_TYPE = re.compile(
    rf"(?P<package>{_NAME})/(?:(?P<msg>msg)/(?P<message>{_NAME})|"
    rf"(?P<srv>srv)/(?P<service>{_NAME}?){_OF_SERVICE}|(?P<action>action)/(?P<goal>{_NAME}?){_OF_ACTION})",
    re.ASCII,
)


def short_type_name(type_name: str) -> str:
    """``std_srvs/SetBool_Event`` for ``std_srvs/srv/SetBool_Event``; a name of two parts stays."""
    package, _, rest = type_name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}" if rest else type_name


def full_type_name(name: str, package: str, kind: str = "msg") -> str:
    """``std_msgs/msg/Header`` for ``std_msgs/Header``, or for ``Header`` in that package.

    The name is that of a type of ``kind`` where it can be one, else that of a message.
    """
    of, _, rest = name.rpartition("/")
    if "/" in of:
        return name
    wanted = f"{of or package}/{kind}/{rest}"
    return wanted if TypeName.read(wanted) else f"{of or package}/msg/{rest}"


def ros_type_name(text: str, serialization_format: str) -> str:
    """The name as ROS 2 has it of a type that DDS, IDL or an exporter calls otherwise.

    Such are ``nav_msgs/Odometry`` and ``nav_msgs::msg::dds_::Odometry_``; what is none of these stays, and so
    does the type of messages that are not CDR.
    """
    if serialization_format != "cdr":
        return text
    parts = text.replace("::", "/").split("/")
    if "dds_" in parts:
        parts = [part.removesuffix("_") for part in parts if part != "dds_"]
    # Of an action's messages, some may be a service's as well.
    kinds = ("action", "srv", "msg") if len(parts) == 2 else ()
    names = ("/".join(parts), *(f"{parts[0]}/{kind}/{parts[1]}" for kind in kinds))
    return next((one for one in names if TypeName.read(one)), text)


@dataclass(frozen=True, slots=True, kw_only=True)
class TypeName:
    """``std_srvs/srv/SetBool_Event``: of ``kind`` srv (or msg, action), and ``defined_in`` SetBool."""

    package: str
    kind: str
    defined_in: str
    name: str

    @classmethod
    def read(cls, text: str) -> TypeName | None:
        """``None`` where ``text`` is not the name of a type of messages."""
        match = _TYPE.fullmatch(text)
        if match is None:
            return None
        kind = match["msg"] or match["srv"] or match["action"]
        return cls(
            package=match["package"],
            kind=kind,
            defined_in=match["message"] or match["service"] or match["goal"],
            name=text.rpartition("/")[2],
        )
