# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag, and what it is told: its rules tried on it, in JSON.

Times are seconds since the bag's start. ``…_bins`` have one value for each stretch of ``bin_s`` seconds.
"""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

TruthName = Literal["true", "false", "unknown"]


class TryRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/try`` → ``TryAnswer``; ``run`` names the try in ``Progress`` messages of ``/ws``."""

    text: str
    bag: str
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"
    run: str = ""


class TryTopic(Struct, frozen=True, kw_only=True):
    """One topic of the bag before and after; ``*_hz_bins`` are messages a second, bin by bin."""

    topic: str
    before_kb: float
    after_kb: float
    before_messages: int
    after_messages: int
    target_hz: float | None
    before_hz_bins: tuple[float, ...]
    after_hz_bins: tuple[float, ...]


class TryBlock(Struct, frozen=True, kw_only=True):
    """A rule, or its Else, by the line that it begins at, and what it turned to when; it starts unknown."""

    rule: str
    line: int
    turns: tuple[tuple[float, TruthName], ...]


class ErrorModel(Struct, frozen=True, kw_only=True):
    """An error over time in the field's unit; the relative ones are shares of its range, or null."""

    rmse: float
    max: float
    relative_rmse: float | None
    relative_max: float | None


class AgeModel(Struct, frozen=True, kw_only=True):
    """Time since the newest message received, in s; ``unseen_s`` is that before the first of them."""

    mean_s: float
    p95_s: float
    max_s: float
    unseen_s: float


class ArmModel(Struct, frozen=True, kw_only=True):
    """What was sent or received of a topic; ``age`` is null where nothing was."""

    messages: int
    bytes: int
    age: AgeModel | None


class TryTopicLoss(Struct, frozen=True, kw_only=True):
    """How old a topic was; the bins have the greatest age in s."""

    topic: str
    sent: ArmModel
    received: ArmModel
    age_s_bins: tuple[float | None, ...]


class TryFieldLoss(Struct, frozen=True, kw_only=True):
    """How far a field's last value received was from the robot's; the bins have the largest error.

    ``hold`` is null where nothing of it was received.
    """

    topic: str
    field: str
    unit: str
    range: float
    hold: ErrorModel | None
    error_bins: tuple[float | None, ...]


class TryCrossing(Struct, frozen=True, kw_only=True):
    """How the operator saw a value cross the threshold of a check."""

    check: str
    crossings: int
    in_time: int
    late: int
    missed: int
    late_mean_s: float | None
    late_max_s: float | None


class FramesModel(Struct, frozen=True, kw_only=True):
    """Frames of images, and the longest time without a new one, in s."""

    frames: int
    longest_blind_s: float


class TryImages(Struct, frozen=True, kw_only=True):
    """A topic of images as sent and as received."""

    topic: str
    sent: FramesModel
    received: FramesModel


class TryLoss(Struct, frozen=True, kw_only=True):
    """What the operator would lose: the numbers of ``testudo bag loss``, without its third arm."""

    topics: tuple[TryTopicLoss, ...]
    fields: tuple[TryFieldLoss, ...]
    crossings: tuple[TryCrossing, ...]
    images: tuple[TryImages, ...]


class TryAnswer(Struct, frozen=True, kw_only=True):
    """What the rules would have done to a bag; ``percent`` is how much less was sent.

    ``first_bin_s`` is when the first bin begins, 0 or less. ``decisions`` are as in a decision log, the first
    2000 of ``decision_count``; ``path`` is ``[seconds, x, y]`` in metres where the bag has odometry.
    """

    duration_s: float
    bin_s: float
    first_bin_s: float
    before_kb: float
    after_kb: float
    percent: float
    decisions: tuple[dict[str, object], ...]
    decision_count: int
    topics: tuple[TryTopic, ...]
    path: tuple[tuple[float, float, float], ...]
    blocks: tuple[TryBlock, ...]
    loss: TryLoss
    notices: tuple[str, ...]
