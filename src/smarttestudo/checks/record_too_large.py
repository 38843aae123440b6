# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings whose time before the event does not fit into memory."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import WrittenRecord
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB, NS_PER_S

_KB_PER_MB = BYTES_PER_MB / BYTES_PER_KB


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.recordings:
        kb_per_s = _kb_per_s(book, one)
        needed_mb = kb_per_s * one.record.before.ns / NS_PER_S / _KB_PER_MB
        if needed_mb > DEFAULT_INCIDENT_MEMORY_MB:
            fits_ms = int(1000 * DEFAULT_INCIDENT_MEMORY_MB * _KB_PER_MB / kb_per_s)
            fits = f"{fits_ms // 1000} s" if fits_ms >= 1000 else f"{fits_ms} ms"
            yield Found(
                path=one.block.path,
                span=one.record.before.span,
                message=f"so much before takes {needed_mb:.0f} MB of the {DEFAULT_INCIDENT_MEMORY_MB} MB "
                "that are kept in memory",
                hint=f"Before {fits} would fit, or name fewer topics; --incident-memory gives more, "
                "--incident-ring keeps the rest on disk",
            )


def _kb_per_s(book: RuleModel, one: WrittenRecord) -> float:
    """What its topics bring in a second, as far as the profile knows."""
    known = (book.context.topic(topic) for topic in one.topics or book.mentions)
    return sum((topic.message_kb or 0.0) * (topic.source_hz or 0.0) for topic in known)


_PROFILE = Profile(
    topics={
        "/odom": TopicProfile(message_kb=0.7, source_hz=30.0),
        "/camera/image_raw": TopicProfile(message_kb=6221.0, source_hz=30.0),
    }
)

CHECK = RuleCheck(
    code="record-too-large",
    severity=Severity.WARNING,
    meaning="What a Record keeps from before the event does not fit into memory.",
    why="The largest topics then lack their oldest messages in the recording, and it says how many, "
    "unless the robot keeps the rest on disk (--incident-ring). Raw images are the usual cause; the "
    "compressed topic fits.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom speed > 1 Then
    SetFrequency /odom 20
    Record "fast" /odom /camera/image_raw Before 30 s After 10 s
end
""",
        profile=_PROFILE,
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency /camera/image_raw 1
  If CheckValue /odom speed > 1 Then
    SetFrequency /odom 20
    Record "fast" /odom Before 30 s After 10 s
end
""",
        profile=_PROFILE,
    ),
    find=_find,
)
