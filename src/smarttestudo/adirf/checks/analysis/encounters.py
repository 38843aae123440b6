# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where branches that set different rates apply together, or meet."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from smarttestudo.adirf.boxes import Box, Domain, Effort, border_between, common_box, find_box
from smarttestudo.adirf.checks.analysis.atlas import Atlas
from smarttestudo.adirf.checks.analysis.results import Clash, Meeting, State
from smarttestudo.adirf.checks.written import Branch
from smarttestudo.domain.signal import Signal


def clashes_of(branch: Branch, atlas: Atlas, domain: Domain, effort: Effort) -> Iterator[Clash]:
    """The clashes of ``branch`` with branches before it in the file, each found when it is asked for.

    Raises ``TooComplexError`` when ``effort`` is spent.
    """
    settled: set[int] = set()
    for other, other_box, box in _pairs(branch, atlas, effort):
        if other.order in settled or other.block.priority != branch.block.priority:
            continue
        topics = differing_topics(other, branch)
        common = common_box(other_box, box)
        if not topics or common is None:
            continue
        settled.add(other.order)
        if not (atlas.territory(branch).is_exact and atlas.territory(other).is_exact):
            common = find_box([other.form, branch.form], domain, effort)
        if common is not None:
            yield Clash(first=other, second=branch, topics=topics, state=sample_state(common))


def meetings_of(
    branch: Branch, atlas: Atlas, wavers: Callable[[Signal], bool], domain: Domain, effort: Effort
) -> Iterator[Meeting]:
    """The meetings of ``branch`` with branches before it in the file, on signals of which ``wavers`` is true.

    Raises ``TooComplexError`` when ``effort`` is spent.
    """
    tried: set[int] = set()
    for other, other_box, box in _pairs(branch, atlas, effort):
        if other.order in tried or not atlas.territory(other).is_exact:
            continue
        border = border_between(other_box, box)
        topics = differing_topics(other, branch)
        if border is None or not topics or not wavers(border.signal):
            continue
        tried.add(other.order)
        if find_box([other.form, branch.form], domain, effort) is None:
            yield Meeting(first=other, second=branch, topics=topics, border=border)


def _pairs(branch: Branch, atlas: Atlas, effort: Effort) -> Iterator[tuple[Branch, Box, Box]]:
    """Each branch before this one with a box of its own near a box of this one's."""
    for neighbourhood in atlas.neighbourhoods(branch):
        for box in atlas.territory(branch).boxes:
            for other, other_box in atlas.around(branch, box, neighbourhood, effort):
                if other.order < branch.order and other.block is not branch.block:
                    effort.spend(len(box) + len(other_box))
                    yield other, other_box, box


def differing_topics(first: Branch, second: Branch) -> tuple[str, ...]:
    """The topics that both set, to rates that are known to differ."""
    return tuple(
        topic
        for topic in second.settings
        if topic in first.settings
        and (one := first.rate(topic)) is not None
        and (other := second.rate(topic)) is not None
        and one.hz != other.hz
    )


def sample_state(box: Box) -> State:
    """A state in ``box``, in round numbers where it can be."""
    return {signal: region.sample() for signal, region in sorted(box.items())}
