# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Settings of a robot's end of a link, and what goes with any end."""

from __future__ import annotations

import math
import platform
import re
from dataclasses import replace

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.link import command_topics
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.profile import budget_kb_per_s
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.robot.option import (
    Option,
    OptionValueError,
    Settings,
    is_true,
    number,
    optional,
    path,
    texts,
)


def _accepted(value: ParameterValue) -> tuple[str, ...]:
    return command_topics(texts(value), ACCEPT.flag or "")


_OFF, _ON, _AUTO = 0, -1, -2
"""No port: no datagrams, or those at the port of the endpoint, where that can be or else not at all."""
_WORDS = {"": _AUTO, "auto": _AUTO, "on": _ON, "off": _OFF}
_LAST_PORT = 65_535
_LAST_DSCP = 63


def _datagrams(value: ParameterValue) -> int:
    if isinstance(value, int) and value in _WORDS.values():
        return int(value)
    text = str(value)
    if text in _WORDS:
        return _WORDS[text]
    if not (text.isascii() and text.isdecimal() and 0 < int(text) <= _LAST_PORT):
        raise OptionValueError(f"{text[:80]!r} is not a port from 1 to {_LAST_PORT}, auto, on or off")
    return int(text)


def _dscp(value: ParameterValue) -> int:
    dscp = number("a class", 0, _LAST_DSCP)(value)
    if not dscp.is_integer():
        raise OptionValueError(f"{dscp} is not a whole number from 0 to {_LAST_DSCP}")
    return int(dscp)


LINK = Option(
    flag="--link",
    metavar="ENDPOINT",
    help="send what is relayed to 'testudo receive' there, as in tls/192.168.1.5:7447; the ROS graph "
    "gets it too only with --output-topic or --output-domain",
    read=texts,
    default=(),
    is_list=True,
)
LINK_LISTEN = Option(
    flag="--link-listen",
    metavar="ENDPOINT",
    help="wait there for 'testudo receive --connect' instead",
    read=texts,
    default=(),
    is_list=True,
)
ROBOT_NAME = Option(
    flag="--robot",
    metavar="NAME",
    help="the robot's name for operators (default: this host's name)",
    read=lambda value: str(value or ""),
)
ACCEPT = Option(
    flag="--accept",
    metavar="TOPIC",
    nargs="+",
    help="publish what 'testudo receive --send' sends of these topics, unless it is older than 0.5 s",
    read=_accepted,
    default=(),
    is_list=True,
)
FETCH_BUDGET = Option(
    flag="--fetch-budget",
    metavar="N",
    help="KB/s of the link that incidents and gaps may take when operators fetch them (default: all "
    "that live topics leave)",
    read=optional(budget_kb_per_s),
    default=None,
)
ZENOH_CONFIG = Option(
    flag="--zenoh-config",
    metavar="FILE",
    help="certificates, users and access control of the link: a Zenoh configuration (JSON5)",
    read=path,
)
INSECURE = Option(
    flag="--insecure",
    help="allow endpoints that other machines reach without TLS: others can read and change what is sent",
    read=is_true,
    default=False,
)
DATAGRAMS = Option(
    flag="--datagrams",
    metavar="PORT|auto|on|off",
    help="send what is relayed as datagrams (UDP) at that port, for radios that lose packets; on: at the "
    "port of the endpoint, on links to other machines; auto: as on, while packets are lost, and not where "
    "this end cannot; both ends need it (default: auto)",
    read=_datagrams,
    default="auto",
)
DSCP = Option(
    flag="--dscp",
    metavar="N",
    help="the class of datagrams for access points and routers, from 0 to 63, as in 46 (default: 0)",
    read=_dscp,
    default=0,
    is_number=True,
)
DATAGRAM_OPTIONS = (DATAGRAMS, DSCP)
"""What goes with the two ends of a link between which messages are relayed."""
SECURITY_OPTIONS = (ZENOH_CONFIG, INSECURE)
"""What goes with any end of a link."""
LINK_OPTIONS = (
    LINK,
    LINK_LISTEN,
    ROBOT_NAME,
    ACCEPT,
    FETCH_BUDGET,
    *DATAGRAM_OPTIONS,
    *SECURITY_OPTIONS,
)


def has_link(settings: Settings) -> bool:
    return bool(settings[LINK] or settings[LINK_LISTEN])


def with_datagrams(options: LinkOptions, settings: Settings) -> LinkOptions:
    """The same link with what is said of its datagrams."""
    said = settings[DATAGRAMS]
    return replace(
        options,
        has_datagrams=said != _OFF,
        needs_datagrams=said not in (_OFF, _AUTO),
        datagrams_port=said if said > _OFF else None,
        dscp=settings[DSCP],
    )


def robot_name(settings: Settings) -> str:
    return settings[ROBOT_NAME] or re.sub(r"[^A-Za-z0-9_]", "_", platform.node()) or "robot"


def link_options(settings: Settings) -> LinkOptions | None:
    """The link that there is to be, if any. Raises ``UsageError`` for what only goes with one."""
    if not has_link(settings):
        for option in (ACCEPT, ROBOT_NAME, FETCH_BUDGET, *DATAGRAM_OPTIONS, *SECURITY_OPTIONS):
            # A budget of 0 is given, too.
            if settings[option] != option.read(option.default):
                raise UsageError("it needs a link", place=option.flag, remedy="add --link or --link-listen")
        return None
    budget = settings[FETCH_BUDGET]
    options = LinkOptions(
        listen=settings[LINK_LISTEN],
        connect=settings[LINK],
        config_file=settings[ZENOH_CONFIG],
        insecure=settings[INSECURE],
        commands=settings[ACCEPT],
        fetch_budget_kb_per_s=math.inf if budget is None else budget,
    )
    return with_datagrams(options, settings)
