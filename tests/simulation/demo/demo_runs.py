# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Demos run as a user runs them, and their bags read with another library than ours."""

from __future__ import annotations

import io
from collections import Counter, defaultdict
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from rosbags.rosbag2 import Reader

from made_demos import Ran
from smarttestudo.cli.main import main
from smarttestudo.domain.names import DECISIONS_TOPIC


def run_testudo(*arguments: object) -> Ran:
    stdout, stderr = io.StringIO(), io.StringIO()
    with redirect_stdout(stdout), redirect_stderr(stderr):
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as exit_:
            code = int(exit_.code or 0)
    return Ran(code=code, stdout=stdout.getvalue(), stderr=stderr.getvalue())


def without_replay(ran: Ran) -> str:
    """What a demo said before its last line, which names the ``testudo`` of this machine."""
    return ran.stdout.rstrip().rpartition("\n")[0] + "\n"


GOLDEN = Path(__file__).parent / "golden"
Messages = dict[str, list[tuple[int, bytes]]]


def robots_messages_of(bag: Path) -> Messages:
    """Those of the robot's own topics, without what a replay decided."""
    return {topic: found for topic, found in messages_of(bag).items() if topic != DECISIONS_TOPIC}


def messages_of(bag: Path) -> Messages:
    """Stamps and payloads by topic, as rosbags reads them."""
    found: Messages = defaultdict(list)
    with Reader(bag) as reader:
        for connection, stamp_ns, payload in reader.messages():
            found[connection.topic].append((stamp_ns, bytes(payload)))
    return dict(found)


def binned_hz(messages: list[tuple[int, bytes]]) -> float:
    """The thesis's frequency: the mean count of the epoch's seconds from the first to the last message."""
    per_second = Counter(stamp_ns // 10**9 for stamp_ns, _ in messages)
    return sum(per_second.values()) / (max(per_second) - min(per_second) + 1)
