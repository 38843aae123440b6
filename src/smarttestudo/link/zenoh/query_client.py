# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions to robots' ends of links, and which of these are there."""

from __future__ import annotations

from collections.abc import Callable

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.link.protocol.keys import ALL_BOOTS, Boot, boot_of
from smarttestudo.link.protocol.messages import MAX_QUESTION_BYTES, REFUSALS
from smarttestudo.link.protocol.wire import other_version, version_sentence
from smarttestudo.link.zenoh.compression import unpacked
from smarttestudo.link.zenoh.session import robot_peer

Reply = bytes | LinkError | None
"""The frame that a robot answered, why it did not, or nothing where it is silent."""
Present = Callable[[Boot, bool], None]
"""Takes whether a run of a robot's end is there; called by threads of Zenoh."""


class QueryClient:
    """Asks robots over ``session``, once there is one."""

    def __init__(self, session: zenoh.Session | None) -> None:
        self._session = session
        self._kept: object = None

    @property
    def problem(self) -> str | None:
        """Why nobody is connected."""
        return None

    def begin(self, present: Present, all_known: Callable[[], None]) -> None:
        """Say who is there, and once that these are all who were there before."""
        assert self._session is not None
        liveliness = self._session.liveliness()

        def on_sample(sample: zenoh.Sample) -> None:
            boot = boot_of(str(sample.key_expr))
            if boot is not None:
                present(boot, sample.kind == zenoh.SampleKind.PUT)

        def on_reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                on_sample(reply.ok)

        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = liveliness.declare_subscriber(ALL_BOOTS, on_sample, history=True)
        handler = zenoh.handlers.Callback(on_reply, all_known)
        liveliness.get(ALL_BOOTS, handler, timeout=ANSWER_WITHIN_S)

    def get(
        self,
        key: str,
        payload: bytes | None,
        answered: Callable[[Reply], None],
        timeout_s: float = ANSWER_WITHIN_S,
        *,
        priority: zenoh.Priority = zenoh.Priority.DATA_LOW,
        congestion_control: zenoh.CongestionControl = zenoh.CongestionControl.BLOCK,
    ) -> None:
        """Have ``answered`` called once with what came of a question, by any thread.

        The answer has its priority, too: messages of the robot's topics go before a long one.
        """
        session = self._session
        replies: list[Reply] = []

        def on_reply(reply: zenoh.Reply) -> None:
            replies.append(_reply(key, reply))

        def ended() -> None:
            answered(next((one for one in replies if one is not None), None))

        if session is None:
            answered(None)
            return
        try:
            session.get(
                key,
                zenoh.handlers.Callback(on_reply, ended),
                payload=payload,
                timeout=timeout_s,
                priority=priority,
                congestion_control=congestion_control,
            )
        except zenoh.ZError:
            answered(None)

    def close(self) -> None:
        """Leave; the session is closed by who opened it."""
        self._kept = None


def _reply(key: str, reply: zenoh.Reply) -> Reply:
    said = reply.ok or reply.err
    if said is None:
        return None
    data = bytes(said.payload.to_bytes())
    version, boot = other_version(data), boot_of(key.rpartition("/")[0])
    if version is not None and boot is not None:
        return LinkError(version_sentence(robot_peer(boot), version))
    if reply.ok is not None:
        return data
    try:
        return REFUSALS.from_bytes(unpacked(data, MAX_QUESTION_BYTES)).error()
    except LinkError:
        # Zenoh itself says so where nobody answers in time.
        return None
