# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of a link over Zenoh: the only importer of ``zenoh``, which is imported where this is called."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from smarttestudo.adapters.zenoh.arrivals import MAX_WAITING_BYTES
from smarttestudo.adapters.zenoh.security import LinkOptions
from smarttestudo.domain.errors import LinkError

if TYPE_CHECKING:
    from smarttestudo.adapters.zenoh.operator_end import OperatorEnd
    from smarttestudo.adapters.zenoh.robot_end import RobotEnd

Warn = Callable[[str], None]
"""Says a sentence that somebody should read; called from any thread."""


@contextmanager
def open_robot_end(
    robot: str, options: LinkOptions, warn: Warn, *, clock: Callable[[], int] = time.monotonic_ns
) -> Iterator[RobotEnd]:
    """The end of the link at the robot of that name; nobody need be at the other end yet.

    ``clock`` gives ns from any start. Raises ``LinkError``: the extra is missing, the endpoints or the
    configuration do not work, or they let anybody in; ``UsageError``: the robot has no usable name.
    """
    _require_zenoh()
    from smarttestudo.adapters.zenoh.robot_end import RobotEnd  # noqa: PLC0415  needs zenoh
    from smarttestudo.adapters.zenoh.session import open_session  # noqa: PLC0415  needs zenoh

    with open_session(options, "peer", warn) as session:
        end = RobotEnd(session, robot, warn, clock)
        try:
            yield end
        finally:
            end.close()


@contextmanager
def open_operator_end(
    options: LinkOptions,
    warn: Warn,
    *,
    clock: Callable[[], int] = time.monotonic_ns,
    most_waiting_bytes: int = MAX_WAITING_BYTES,
) -> Iterator[OperatorEnd]:
    """The operator's end of the links of all robots that are or will be there.

    It is a router, so that further ends can connect to where it listens. ``clock`` gives ns from any start;
    ``most_waiting_bytes`` may wait to be read.
    Raises ``LinkError`` as ``open_robot_end`` does.
    """
    _require_zenoh()
    from smarttestudo.adapters.zenoh.operator_end import OperatorEnd  # noqa: PLC0415  needs zenoh
    from smarttestudo.adapters.zenoh.session import open_session  # noqa: PLC0415  needs zenoh

    with open_session(options, "router", warn) as session:
        end = OperatorEnd(session, warn, clock, most_waiting_bytes)
        try:
            yield end
        finally:
            end.close()


def _require_zenoh() -> None:
    try:
        import zenoh  # noqa: F401, PLC0415  most robots and laptops have no link
        import zstandard  # noqa: F401, PLC0415
    except ImportError as error:
        raise LinkError(f"a link needs {error.name}", remedy="pip install 'smarttestudo[link]'") from error
