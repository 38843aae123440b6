# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run in one sentence."""

from __future__ import annotations

from dataclasses import dataclass

from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.bags.comparison import Comparison
from smarttestudo.domain.units import BYTES_PER_GB, BYTES_PER_KB, BYTES_PER_MB, counted, grouped
from smarttestudo.report.table import MISSING, format_number, percent_text

_KB_PER_MB = 1000
_FEWER = 0.97
_TIMES = ((3600.0, "h"), (60.0, "min"), (0.0, "s"))
_WHOLE_FROM = 1000
_VOLUMES = ((1000 * BYTES_PER_GB, "TB"), (BYTES_PER_GB, "GB"), (BYTES_PER_MB, "MB"))
_LENGTHS = ((1.0, 1.0, "m"), (0.01, 100.0, "cm"), (0.0, 1000.0, "mm"))


def summary_sentence(comparison: Comparison, loss: LossReport | None = None) -> str:
    """The bandwidth of all topics, what that cost, and what fixed rates with the same bytes would have cost.

    Of what is not known nothing is said; of a single recording there is only its bandwidth.
    """
    change = comparison.bandwidth_change_percent
    known = comparison.before_kb_per_s is not None
    parts = [bandwidth_text(comparison.before_kb_per_s) if known else "too short to tell a bandwidth"]
    if change is not None:
        parts = [f"{percent_text(change, decimals=0, signed=True)} bandwidth"]
    error = None if loss is None else position_error(loss)
    if error is not None:
        beside_m = error.fixed_m or 0.0
        parts.append(f"{error.topic} error {length_text(error.received_m, beside_m=beside_m)}")
    if error is not None and error.fixed_m is not None:
        parts.append(f"at fixed rates {length_text(error.fixed_m, beside_m=error.received_m)}")
    return ", ".join(parts)


def declared_sentence(comparison: Comparison) -> str:
    """Which figures of a comparison count sizes that the recording declares, and not those that it holds."""
    sizes_kb = {
        pair.topic: pair.before.size_bytes / pair.before.messages / BYTES_PER_KB
        for pair in comparison.topics
        if pair.before is not None and pair.before.declared and pair.before.messages
    }
    if not sizes_kb:
        return "No figure counts declared sizes: all are of messages as they are recorded."
    topics = " and ".join(f"{topic} ({grouped(kb, 1)} KB a message)" for topic, kb in sizes_kb.items())
    return (
        f"Declared sizes are counted for {topics}: in their KB and KB/s, in sums over all topics and in "
        '"the same bytes". Rates, errors and all other sizes are of messages as they are recorded.'
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionError:
    """How far off the held position of one topic was (RMSE, in m), and would have been at fixed rates."""

    topic: str
    received_m: float
    fixed_m: float | None


def position_error(loss: LossReport) -> PositionError | None:
    """The error of the first topic with positions; ``None`` if there is none."""
    for shared in loss.topics:
        received_m = loss.position_rmse_m(shared.topic)
        if received_m is not None:
            fixed_m = loss.fixed_position_rmse_m(shared.topic)
            return PositionError(topic=shared.topic, received_m=received_m, fixed_m=fixed_m)
    return None


def loss_sentences(loss: LossReport) -> tuple[str, ...]:
    """The error of the position, that of fixed rates, and what those pay for theirs; none if unknown."""
    error = position_error(loss)
    if error is None:
        return ()
    received = length_text(error.received_m, beside_m=error.fixed_m or 0.0)
    if error.fixed_m is None:
        return (f"With the last position of {error.topic} held, the error is {received} (RMSE).",)
    fixed = length_text(error.fixed_m, beside_m=error.received_m)
    compared = (
        f"With the last position of {error.topic} held, the error is {received} (RMSE); "
        f"at the best fixed rates for the same bytes, {fixed}."
    )
    price = fixed_price(loss)
    return (compared, price) if price else (compared,)


def fixed_price(loss: LossReport) -> str:
    """Of which topic fixed rates bring fewer messages, the one with the most bytes if several; or nothing."""
    poorer = [topic for topic in loss.topics if topic.fixed.messages < _FEWER * topic.received.messages]
    if not poorer:
        return ""
    topic_loss = max(poorer, key=lambda topic: topic.received.size_bytes)
    return (
        f"For that, fixed rates bring {counted(topic_loss.fixed.messages, 'message')} of {topic_loss.topic}, "
        f"where rules bring {grouped(topic_loss.received.messages)}."
    )


def length_text(length_m: float, *, beside_m: float = 0.0) -> str:
    """``length_m`` in m, cm or mm, whichever reads best for the longer of it and one ``beside_m``."""
    longest_m = max(length_m, beside_m)
    factor, unit = next((factor, unit) for least_m, factor, unit in _LENGTHS if longest_m >= least_m)
    return f"{format_number(length_m * factor, 1)} {unit}"


def volume_text(size_bytes: float) -> str:
    """``size_bytes`` in GB, MB or KB, whichever reads best."""
    unit_bytes, unit = volume_unit(size_bytes)
    return f"{format_number(size_bytes / unit_bytes, 1)} {unit}"


def volume_unit(size_bytes: float) -> tuple[int, str]:
    """The bytes of the unit in which ``size_bytes`` read best, and its name."""
    return next((scale for scale in _VOLUMES if size_bytes >= scale[0]), (BYTES_PER_KB, "KB"))


def time_text(duration_s: float) -> str:
    """``duration_s`` in hours, minutes or seconds, whichever reads best."""
    factor, unit = next(scale for scale in _TIMES if duration_s >= scale[0])
    value = duration_s / (factor or 1.0)
    return f"{format_number(value, 0 if value >= _WHOLE_FROM else 1)} {unit}"


def bandwidth_text(kb_per_s: float | None) -> str:
    """``kb_per_s`` with its unit, MB/s from 1000 KB/s on."""
    if kb_per_s is None:
        return MISSING
    if kb_per_s >= _KB_PER_MB:
        return f"{format_number(kb_per_s / _KB_PER_MB, 1)} MB/s"
    return f"{format_number(kb_per_s, 1)} KB/s"
