# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Headline of a try: what was sent, and the greatest loss."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from smarttestudo.domain.record import Mark
from smarttestudo.domain.units import counted
from smarttestudo.ruler.tries.loss import TryImages, TryLoss, TryTopicLoss

_MAX_NOTICES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstTopic:
    """The topic that lost most: ``received`` of ``sent`` messages, or frames where it ``is_image``.

    ``longest_s`` is the greatest age of its newest message at the operator, or the longest time without a
    frame; ``more_s`` is how much longer that is than at the robot, null where nothing arrived.
    """

    topic: str
    sent: int
    received: int
    longest_s: float
    more_s: Annotated[float, Mark.NULL_IS_INFINITE]
    is_image: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstField:
    """The property with the largest error when its last value is held: its RMSE, ``share`` of its range."""

    topic: str
    field: str
    unit: str
    rmse: float
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TryHeadline:
    """Headline of a try on a bag; ``percent`` is how much less of the relayed topics was sent.

    The worst are null where nothing was lost. ``missed_crossings`` of the ``crossings`` of checks' thresholds
    were not seen by the operator.
    """

    duration_s: float
    before_kb: float
    after_kb: float
    percent: float
    worst_topic: WorstTopic | None
    worst_field: WorstField | None
    crossings: int
    missed_crossings: int
    notices: tuple[str, ...]

    def headline(self) -> TryHeadline:
        """The headline alone, with the first notices."""
        left_out = len(self.notices) - _MAX_NOTICES
        more = (f"{counted(left_out, 'more notice')}",) if left_out > 0 else ()
        return TryHeadline(
            duration_s=self.duration_s,
            before_kb=self.before_kb,
            after_kb=self.after_kb,
            percent=self.percent,
            worst_topic=self.worst_topic,
            worst_field=self.worst_field,
            crossings=self.crossings,
            missed_crossings=self.missed_crossings,
            notices=(*self.notices[:_MAX_NOTICES], *more),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class TriedRecording:
    """``POST /api/try/headline``: the headline of a try, or why the recording cannot be tried."""

    headline: TryHeadline | None
    problem: str = ""
    remedy: str = ""


def worst_topic(loss: TryLoss) -> WorstTopic | None:
    """The topic whose newest message, or picture, was old for longer than at the robot, by the most."""
    images = [_image(one) for one in loss.images]
    shown = {one.topic for one in images}
    others = (_topic(one) for one in loss.topics if one.topic not in shown)
    lost = (one for one in (*images, *others) if one.received < one.sent)
    return max(lost, key=lambda one: one.more_s, default=None)


def worst_field(loss: TryLoss) -> WorstField | None:
    """The property with the largest error as a share of its range, of those that the operator received."""
    return max(_fields(loss), key=lambda one: one.share, default=None)


def _image(loss: TryImages) -> WorstTopic:
    sent, received = loss.sent, loss.received
    return WorstTopic(
        topic=loss.topic,
        sent=sent.frames,
        received=received.frames,
        longest_s=received.longest_blind_s,
        more_s=received.longest_blind_s - sent.longest_blind_s if received.frames else math.inf,
        is_image=True,
    )


def _topic(loss: TryTopicLoss) -> WorstTopic:
    sent_s = loss.sent.age.max_s if loss.sent.age else 0.0
    received = loss.received
    return WorstTopic(
        topic=loss.topic,
        sent=loss.sent.messages,
        received=received.messages,
        longest_s=received.age.max_s if received.age else 0.0,
        more_s=received.age.max_s - sent_s if received.age else math.inf,
        is_image=False,
    )


def _fields(loss: TryLoss) -> Iterator[WorstField]:
    for one in loss.fields:
        if one.hold is not None and one.hold.relative_rmse:
            yield WorstField(
                topic=one.topic,
                field=one.field,
                unit=one.unit,
                rmse=one.hold.rmse,
                share=one.hold.relative_rmse,
            )
