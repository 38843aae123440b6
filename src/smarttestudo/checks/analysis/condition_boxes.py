# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where each condition holds."""

from __future__ import annotations

import itertools

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import (
    Box,
    Domain,
    Effort,
    Hull,
    TooComplexError,
    boxes_where,
    hull_of,
)
from smarttestudo.language.normal_form import Every, Form, InRegion
from smarttestudo.language.region import Region

MAX_BOXES = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionBoxes:
    """The boxes where a condition holds; around them only, where ``is_exact`` is false.

    ``sure_box`` is the first box in all of which it holds, ``None`` where none was found; ``hulls`` are those
    of ``boxes``.
    """

    boxes: tuple[Box, ...]
    hulls: tuple[Hull, ...]
    is_exact: bool
    sure_box: Box | None


def boxes_of(form: Form, domain: Domain, effort: Effort) -> ConditionBoxes:
    """Where ``form`` holds, as at most ``MAX_BOXES`` boxes; one around them all where they are more."""
    boxes: list[Box] = []
    is_exact = False
    try:
        for box in itertools.islice(boxes_where([form], domain, effort), MAX_BOXES + 1):
            boxes.append(box)  # noqa: PERF402 - what was found counts when the effort is spent
        is_exact = len(boxes) <= MAX_BOXES
    except TooComplexError:
        pass
    around = tuple(boxes) if is_exact else (_box_around(form, domain),)
    return ConditionBoxes(
        boxes=around,
        hulls=tuple(map(hull_of, around)),
        is_exact=is_exact,
        sure_box=boxes[0] if boxes else None,
    )


def _box_around(form: Form, domain: Domain) -> Box:
    parts = form.parts if isinstance(form, Every) else (form,)
    around: dict[Signal, Region] = {}
    for part in parts:
        if isinstance(part, InRegion):
            region = around.get(part.signal, domain(part.signal)).intersection(part.region)
            around[part.signal] = region
    return {signal: region for signal, region in around.items() if not region.is_empty}
