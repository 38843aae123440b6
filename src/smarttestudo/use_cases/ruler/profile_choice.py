# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which profile of a project a rule file is most likely meant for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath

from smarttestudo.adirf.parser import ParseResult
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.use_cases.ruler.vocabulary import topics_in


def profile_for(name: str, rules: ParseResult, profiles: Mapping[str, Profile]) -> str | None:
    """Of ``profiles``, by name, the one for the rule file ``name``; ``None`` where none has to do with it.

    That is the one of the same name; else the one that knows the most of the rules' topics, of equals one in
    the same folder. Rules without a topic yet are at home in their folder.
    """
    own = PurePosixPath(name)
    topics = {resolve_topic(topic) for topic in topics_in(rules)}

    def merits(candidate: str) -> tuple[bool, int, bool]:
        path = PurePosixPath(candidate)
        is_near = path.parent == own.parent
        return is_near and path.stem == own.stem, len(topics & set(profiles[candidate].topics)), is_near

    best = max(sorted(profiles), key=merits, default=None)
    if best is None:
        return None
    is_namesake, known, is_near = merits(best)
    return best if is_namesake or known > 0 or (is_near and not topics) else None
