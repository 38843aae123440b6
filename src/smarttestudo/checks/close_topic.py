# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topic that a misspelt name means."""

from __future__ import annotations

import difflib
from collections.abc import Collection

from smarttestudo.domain.finding import Fix
from smarttestudo.language.syntax import TopicName


def close_topic(topic: str, known: Collection[str]) -> str | None:
    """The known topic that is spelt almost like ``topic``; ``None`` where there is none."""
    return next(iter(difflib.get_close_matches(topic, known, n=1, cutoff=0.75)), None)


def write_topic(name: TopicName, topic: str | None) -> Fix | None:
    """A fix that writes ``topic`` in the place of ``name``."""
    return None if topic is None else Fix(span=name.span, replacement=topic, title=f"write {topic}")
