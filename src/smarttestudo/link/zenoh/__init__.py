# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of a link over Zenoh: the only importer of ``zenoh``, which is imported where this is called."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from smarttestudo.domain.errors import Extra, LinkError, how_to_install, said
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.arrivals import MAX_WAITING_BYTES
from smarttestudo.link.zenoh.security import LinkOptions, has_datagrams

if TYPE_CHECKING:
    from smarttestudo.link.zenoh.incidents import LinkIncidents
    from smarttestudo.link.zenoh.link_client import LinkClient, LinkClients
    from smarttestudo.link.zenoh.link_robots import LinkRobots
    from smarttestudo.link.zenoh.operator_end import OperatorEnd
    from smarttestudo.link.zenoh.robot_end import RobotEnd

Warn = Callable[[str], None]
"""Says a sentence that somebody should read; called from any thread."""


def suspended_too_ns() -> int:
    """Time that passes while the machine is suspended, too, where the system has such a clock."""
    if sys.platform == "linux":
        return time.clock_gettime_ns(time.CLOCK_BOOTTIME)
    return time.monotonic_ns()


@contextmanager
def open_robot_end(
    robot: str, options: LinkOptions, warn: Warn, *, clock: Callable[[], int] = suspended_too_ns
) -> Iterator[RobotEnd]:
    """The end of the link at the robot of that name; nobody need be at the other end yet.

    ``clock`` gives ns from any start. After one that stood still while the machine was suspended, messages
    look late for a minute. Raises ``LinkError``: the extra is missing, the endpoints or the configuration do
    not work, or they let anybody in; ``UsageError``: the robot has no usable name, or ``options`` have
    commands over endpoints that let anybody in.
    """
    require_zenoh()
    from smarttestudo.link.zenoh.commands import CommandInbox  # noqa: PLC0415  needs zenoh
    from smarttestudo.link.zenoh.robot_end import RobotEnd  # noqa: PLC0415  needs zenoh
    from smarttestudo.link.zenoh.session import open_session  # noqa: PLC0415  needs zenoh

    with open_session(options, "peer", warn) as opened:
        end = RobotEnd(opened, robot, warn, clock, options.fetch_budget_kb_per_s)
        try:
            have_datagrams(options, end.offer_datagrams, warn)
            if not options.commands:
                yield end
                return
            end.commands = CommandInbox(opened.session, end.boot, options.commands, warn, suspended_too_ns)
            with closing(end.commands):
                yield end
        finally:
            end.close()


@contextmanager
def open_operator_end(
    options: LinkOptions,
    warn: Warn,
    *,
    clock: Callable[[], int] = suspended_too_ns,
    most_waiting_bytes: int = MAX_WAITING_BYTES,
    predicts: frozenset[str] = frozenset(),
    receiver: int | None = None,
) -> Iterator[OperatorEnd]:
    """The operator's end of the links of all robots that are or will be there.

    It is a router, so that further ends can connect to where it listens. ``clock`` gives ns from any start;
    ``most_waiting_bytes`` may wait to be read; ``predicts`` are the topics, by the robots' names, that who
    reads reckons where the robot's end does so too; ``receiver`` is the number by which robots know it.
    Raises ``LinkError`` as ``open_robot_end`` does.
    """
    require_zenoh()
    from smarttestudo.link.zenoh.commands import CommandOutbox  # noqa: PLC0415  needs zenoh
    from smarttestudo.link.zenoh.operator_end import OperatorEnd  # noqa: PLC0415  needs zenoh
    from smarttestudo.link.zenoh.session import open_session  # noqa: PLC0415  needs zenoh

    with open_session(options, "router", warn) as (session, watch):
        watcher = Worker("link-watch", lambda error: warn(said(error)), watch)
        end = OperatorEnd(session, warn, clock, most_waiting_bytes, predicts, receiver=receiver)
        try:
            have_datagrams(options, end.take_datagrams, warn)
            if options.connect:
                watcher.start()
            if options.commands:
                end.commands = CommandOutbox(session, options.commands, warn, suspended_too_ns)
            yield end
        finally:
            watcher.close()
            end.close()


@contextmanager
def open_link_robots(
    options: LinkOptions, warn: Warn, *, steady_s: Callable[[], float] = time.monotonic
) -> Iterator[LinkRobots]:
    """The robots that are heard where ``options`` connect to, whether or not anybody answers there yet.

    ``steady_s`` is a clock that never jumps. Raises ``LinkError`` as ``open_robot_end`` does.
    """
    require_zenoh()
    from smarttestudo.link.zenoh.link_robots import LinkRobots  # noqa: PLC0415  needs zenoh

    client = _client(options, warn)
    robots = LinkRobots(client, ", ".join(options.connect), steady_s)
    try:
        yield robots
    finally:
        client.close()


@contextmanager
def open_link_incidents(options: LinkOptions, warn: Warn) -> Iterator[LinkIncidents]:
    """The incidents of the robots that are heard where ``options`` connect to, as ``RemoteIncidents``.

    Raises ``LinkError`` as ``open_robot_end`` does.
    """
    require_zenoh()
    from smarttestudo.link.zenoh.incidents import LinkIncidents  # noqa: PLC0415  needs zenoh

    client = _client(options, warn)
    incidents = LinkIncidents(client, ", ".join(options.connect))
    try:
        yield incidents
    finally:
        incidents.close()


def _client(options: LinkOptions, warn: Warn) -> LinkClient | LinkClients:
    from smarttestudo.link.zenoh.link_client import LinkClient, LinkClients  # noqa: PLC0415  needs zenoh
    from smarttestudo.link.zenoh.session import session_config  # noqa: PLC0415  needs zenoh

    config, known = session_config(options, "client", warn)
    if len(options.connect) == 1:
        return LinkClient(config, known, options.connect)
    at_each = [replace(options, connect=(endpoint,)) for endpoint in dict.fromkeys(options.connect)]
    return LinkClients(
        [LinkClient(*session_config(own, "client", lambda _: None), own.connect) for own in at_each]
    )


def have_datagrams(options: LinkOptions, have: Callable[[LinkOptions], None], warn: Warn) -> None:
    """Have datagrams beside a link where they are to be; ``warn`` is told why there can be none.

    Raises ``LinkError`` where there can be none beside a link that needs them.
    """
    if not has_datagrams(options):
        return
    try:
        _require_cryptography()
        have(options)
    except LinkError as error:
        if options.needs_datagrams:
            raise
        cause = f"{error.place}: {error.cause}" if error.place else error.cause
        warn(f"{cause}: what is relayed goes over the reliable link; {error.remedy}")


def _require_cryptography() -> None:
    try:
        import cryptography  # noqa: F401, PLC0415  see above
    except ImportError as error:
        cause = "datagrams need the package cryptography"
        raise LinkError(cause, remedy=how_to_install(Extra.LINK)) from error


def require_zenoh() -> None:
    """Raise ``LinkError`` where a package of the extra ``link`` is missing."""
    try:
        import zenoh  # noqa: F401, PLC0415  most robots and laptops have no link
        import zstandard  # noqa: F401, PLC0415
    except ImportError as error:
        cause = f"a link needs the package {error.name}"
        raise LinkError(cause, remedy=how_to_install(Extra.LINK)) from error
