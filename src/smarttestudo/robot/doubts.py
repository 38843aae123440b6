# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Warns of topics that are not shown as their rates say."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.robot import RobotLog
from smarttestudo.domain.status import ThinningDoubt, TopicStatus


class LiveDoubts:
    """Warns of each doubt about a topic once."""

    def __init__(self, log: RobotLog) -> None:
        self._log = log
        self._said: set[tuple[str, ThinningDoubt]] = set()

    def say(self, topics: Mapping[str, TopicStatus]) -> None:
        """Warn of what was not said of these topics yet."""
        for topic, status in topics.items():
            doubt = status.doubt
            if doubt is not None and (topic, doubt) not in self._said:
                self._said.add((topic, doubt))
                self._log.warning(f"{topic}: {doubt.value}: {doubt.details}")
