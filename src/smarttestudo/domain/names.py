# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of ROS 2 topics, of relayed topics, and of message types."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from smarttestudo.domain.errors import RosError, UsageError

_PART = r"[A-Za-z_][A-Za-z0-9_]*"
TOPIC_FORM = rf"(?:~/?|/)?(?:{_PART})(?:/{_PART})*"
"""What names of topics look like, but that no two ``_`` follow each other; of any dialect of expressions."""
_TOPIC = re.compile(rf"{TOPIC_FORM}\Z")
MAX_NAME_LENGTH = 247
"""ROS 2's own limit: the middleware has 255 letters, of which eight are kept for prefixes such as ``rt/``."""
STATUS_TOPIC = "/testudo/status"
DECISIONS_TOPIC = "/testudo/decisions"
OWN_TOPICS = frozenset({DECISIONS_TOPIC, STATUS_TOPIC})
"""What a SmartTestudo node alone publishes. ``/diagnostics`` and its like have publishers in many nodes."""
TEXT_TYPE = "std_msgs/msg/String"
NAME_OPTION = "--ros-args -r __node:=smarttestudo_2"
"""How `testudo run` gets another name than the node of another robot on its ROS graph."""
TOPIC_PLACEHOLDER = "{topic}"
ROBOT_PLACEHOLDER = "{robot}"


def is_topic_name(name: str) -> bool:
    """Whether ``name`` is a valid ROS 2 topic name: absolute, relative or private (``~/x``)."""
    return len(name) <= MAX_NAME_LENGTH and has_topic_form(name)


def has_topic_form(name: str) -> bool:
    """Whether ``name`` is a topic name of any length."""
    return "__" not in name and _TOPIC.match(name) is not None


_ANY_NAME = "any_topic"
_PATTERN_STAR = re.compile(r"(?:(?<=/)|\A)\*{1,2}(?=/|\Z)")
MACHINE, LINK = "@machine", "@link"
SOURCES = (MACHINE, LINK)
"""Beside topics, checks read the machine that a run is on, and its link."""


def is_source(name: str) -> bool:
    """Whether ``name`` is that of the machine or the link, in place of a topic."""
    return name in SOURCES


def is_topic_pattern(name: str) -> bool:
    """Whether ``name`` stands for topics of a kind: ``*`` is one name in it, ``**`` any number of them."""
    return "*" in name and is_topic_name(_PATTERN_STAR.sub("x", name))


def is_known_to_ros(name: str) -> bool:
    """Whether ROS 2 answers questions about ``name``: DDS has topics that it lists and then refuses."""
    return len(name) <= MAX_NAME_LENGTH and _TOPIC.match(name) is not None


def require_publishable(name: str, topic: str) -> None:
    """Raise ``RosError`` where ``name``, under which ``topic`` is to be published, is too long for ROS 2."""
    if len(name) > MAX_NAME_LENGTH:
        raise RosError(
            f"its name here would have {len(name)} letters, and ROS 2 takes {MAX_NAME_LENGTH}",
            place=topic,
            remedy="give it a shorter name, or choose a shorter --output-topic",
        )


def is_own_topic(name: str, type_name: str) -> bool:
    """Whether a recorded topic is what a SmartTestudo node said of itself, perhaps below a robot's name."""
    return type_name == TEXT_TYPE and any(name.endswith(own) for own in OWN_TOPICS)


def is_topic_prefix(text: str) -> bool:
    """Whether full names can begin with ``text``, as with ``/tb3_0``; nothing is a prefix, too."""
    return not text or (text.startswith("/") and is_topic_name(text))


def resolve_topic(name: str, *, namespace: str = "/", node: str = "smarttestudo", prefix: str = "") -> str:
    """The full name of ``name`` for a node in ``namespace``, with ``prefix`` before it."""
    base = namespace.rstrip("/")
    if name.startswith("/"):
        full = name
    elif name.startswith("~"):
        full = f"{base}/{node}/{name[1:].lstrip('/')}"
    else:
        full = f"{base}/{name}"
    return f"{prefix.rstrip('/')}{full}"


def resolved_pattern(name: str, resolve: Callable[[str], str]) -> str:
    """The full name of a topic by ``resolve``, or of a pattern of topics, which ROS takes for no name."""
    beginning, star, rest = name.partition("*")
    if not star:
        return resolve(name)
    return f"{resolve(beginning + _ANY_NAME).removesuffix(_ANY_NAME)}{star}{rest}"


def output_name(topic: str, pattern: str, robot: str | None = None) -> str:
    """Name of ``topic`` by ``pattern``, in which ``{robot}`` stands for a ``robot`` that is given.

    It may be too long (``require_publishable``). Raises ``UsageError`` where ``pattern`` does not hold
    ``{topic}`` or makes no name of it.
    """
    if TOPIC_PLACEHOLDER not in pattern:
        cause = f"{pattern!r} gives all topics the same name"
        raise UsageError(cause, place="--output-topic", remedy="write it with {topic}, as in /testudo{topic}")
    of_robot = robot is not None and ROBOT_PLACEHOLDER in pattern
    named = pattern.replace(ROBOT_PLACEHOLDER, robot or "") if of_robot else pattern
    name = named.replace(TOPIC_PLACEHOLDER, topic)
    if not name.startswith("/") or not has_topic_form(name):
        cause = f"{name!r} is not a valid ROS 2 topic name"
        remedy = "write it as in /testudo{topic}"
        if of_robot:
            remedy = "write it as in /{robot}{topic}, and give the robot a name of letters, digits and _"
        raise UsageError(cause, place="--output-topic", remedy=remedy)
    return name


def is_output_name(topic: str, pattern: str) -> bool:
    """Whether ``topic`` is named as by ``pattern``; never if outputs have the names of their sources."""
    before, _, after = pattern.partition(TOPIC_PLACEHOLDER)
    return bool(before or after) and topic.startswith(f"{before}/") and topic.endswith(after)


OWN_PREFIX = "/testudo/"
"""How the names of what SmartTestudo publishes begin, unless ``--output-topic`` says otherwise."""


def is_own_output(topic: str, pattern: str) -> bool:
    """Whether SmartTestudo publishes ``topic``, where it names its outputs by ``pattern``."""
    return topic.startswith(OWN_PREFIX) or is_output_name(topic, pattern)


def full_topic_names(names: Sequence[str], option: str, *, most: int, like: str) -> tuple[str, ...]:
    """The topics that ``option`` names, each once, as ``like``. Raises ``UsageError``."""
    for name in names:
        if not name.startswith("/") or not is_topic_name(name):
            raise UsageError(
                f"{name[:80]!r} is not the full name of a topic",
                place=option,
                remedy=f"write it as in {like}",
            )
    topics = tuple(dict.fromkeys(names))
    if len(topics) > most:
        raise UsageError(f"{len(topics)} topics are too many", place=option, remedy=f"name at most {most}")
    return topics


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
    return next((name for name in names if TypeName.read(name)), text)


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
