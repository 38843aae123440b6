# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A trial as JSON."""

from __future__ import annotations

from smarttestudo.composition.ruler.replay_watch import BlockTurns
from smarttestudo.composition.ruler.trial import TopicTrial, Trial
from smarttestudo.composition.ruler.trial_loss import TrialLoss
from smarttestudo.visualizer.loss.course import Course
from smarttestudo.visualizer.loss.report import CrossingLoss, FieldLoss, ImageLoss, TopicLoss


def trial_to_json(trial: Trial) -> dict[str, object]:
    """The object that the page gets."""
    return {
        "duration_s": trial.duration_s,
        "bin_s": trial.bin_s,
        "first_bin_s": trial.first_bin_s,
        "before_kb": trial.before_kb,
        "after_kb": trial.after_kb,
        "percent": trial.saved_percent,
        "decisions": [decision.to_json() for decision in trial.decisions],
        "decision_count": trial.decision_count,
        "topics": [_topic(one) for one in trial.topics],
        "path": [[point.t_s, point.x_m, point.y_m] for point in trial.path],
        "blocks": [_block(one) for one in trial.blocks],
        "loss": _loss(trial.loss),
        "notices": trial.notices,
    }


def _topic(one: TopicTrial) -> dict[str, object]:
    return {
        "topic": one.topic,
        "before_kb": one.before_kb,
        "after_kb": one.after_kb,
        "before_messages": one.before_messages,
        "after_messages": one.after_messages,
        "target_hz": one.target_hz,
        "before_hz_bins": one.before_hz_bins,
        "after_hz_bins": one.after_hz_bins,
    }


def _block(one: BlockTurns) -> dict[str, object]:
    return {
        "rule": one.block.label,
        "line": one.block.line,
        "turns": [[round(t_s, 6), truth.name.lower()] for t_s, truth in one.turns],
    }


def _loss(loss: TrialLoss) -> dict[str, object]:
    return {
        "topics": [_topic_loss(one, course) for one, course in loss.topics],
        "fields": [_field_loss(one, course) for one, course in loss.fields],
        "crossings": [_crossing(one) for one in loss.crossings],
        "images": [_image(one) for one in loss.images],
    }


def _topic_loss(one: TopicLoss, course: Course) -> dict[str, object]:
    return {
        "topic": one.topic,
        "sent": one.sent.to_json(),
        "received": one.received.to_json(),
        "age_s_bins": _short(course),
    }


def _field_loss(one: FieldLoss, course: Course) -> dict[str, object]:
    return {
        "topic": one.topic,
        "field": one.field,
        "unit": one.unit,
        "range": one.value_range,
        "hold": one.received.hold.to_json() if one.received else None,
        "error_bins": _short(course),
    }


def _crossing(one: CrossingLoss) -> dict[str, object]:
    return {"check": one.check, "crossings": one.crossings, **one.received.to_json()}


def _image(one: ImageLoss) -> dict[str, object]:
    return {"topic": one.topic, "sent": one.sent.to_json(), "received": one.received.to_json()}


def _short(course: Course) -> list[float | None]:
    """Four digits, which is what a chart can show."""
    return [None if value is None else float(f"{value:.4g}") for value in course]
