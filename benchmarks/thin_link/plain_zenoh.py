# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zenoh as anybody uses it, without a window above it: what the link is compared with."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.zenoh.session import has_subscribers

_KEY = "plain"
_WAYS: Mapping[str, str] = {
    "zenoh": "tcp/{address}",
    "zenoh-udp": "udp/{address}",
    # Zenoh's QUIC without certificates; what is best effort goes in datagrams.
    "zenoh-quic": "udp/{address}?rel=1;mixed_rel=1",
}
"""Zenoh's endpoint, by the contender."""


@contextmanager
def _session(way: str, mode: str, side: str, endpoint: str, *, compresses: bool) -> Iterator[zenoh.Session]:
    config = zenoh.Config()
    address = _WAYS[way].format(address=endpoint.partition("/")[2])
    settings = {
        "mode": mode,
        f"{side}/endpoints": [address],
        "scouting/multicast/enabled": False,
        # Namespaces share /dev/shm: with shared memory, nothing would cross a link between them.
        "transport/shared_memory/enabled": False,
        "transport/unicast/compression/enabled": compresses,
    }
    try:
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise LinkError("plain Zenoh does not open", place=address, remedy="is the address free?") from error
    with session:
        yield session


@contextmanager
def plain_robot(
    way: str, endpoint: str, priorities: Mapping[str, str], *, compresses: bool
) -> Iterator[tuple[Mapping[str, Callable[[bytes], None]], Callable[[], bool]]]:
    """A publisher of each topic with Zenoh's priority of that name, and whether an operator listens.

    What does not fit Zenoh's queues is dropped. Raises ``LinkError``.
    """
    reliability = zenoh.Reliability.RELIABLE if way == "zenoh" else zenoh.Reliability.BEST_EFFORT
    with _session(way, "client", "connect", endpoint, compresses=compresses) as session:
        publishers = {
            topic: session.declare_publisher(
                f"{_KEY}{topic}",
                priority=getattr(zenoh.Priority, priority),
                congestion_control=zenoh.CongestionControl.DROP,
                reliability=reliability,
            )
            for topic, priority in priorities.items()
        }
        puts = {topic: publisher.put for topic, publisher in publishers.items()}
        yield puts, lambda: all(has_subscribers(one) for one in publishers.values())


@contextmanager
def plain_operator(
    way: str, endpoint: str, note: Callable[[str, bytes], None], *, compresses: bool
) -> Iterator[None]:
    """Have ``note`` told topic and payload of all that arrives, in Zenoh's thread. Raises ``LinkError``."""
    with _session(way, "router", "listen", endpoint, compresses=compresses) as session:
        kept = session.declare_subscriber(
            f"{_KEY}/**",
            lambda sample: note(str(sample.key_expr).removeprefix(_KEY), sample.payload.to_bytes()),
        )
        yield
        kept.undeclare()
