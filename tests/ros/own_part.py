# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run`` with a part that a developer adds in one file: it counts messages that are large."""

from __future__ import annotations

import sys
from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import Annotated

from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.run import PART_KINDS, add_arguments
from smarttestudo.domain.metric import Metered, MetricKind
from smarttestudo.domain.robot import Payload, Subscription
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.robot.option import Option, number
from smarttestudo.robot.part import Part, PartContext, PartKind

LARGE_FROM = Option(
    name="large_from_kb",
    flag="--large-from",
    metavar="KB",
    help="count messages of so many KB as large",
    read=number("KB", 0, 1e6),
    default=0.1,
    is_number=True,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class LargeMessages:
    from_kb: float
    seen: Annotated[int, Metered("large", "messages", "Messages that were large.", MetricKind.COUNTER)]


class CountsLargeMessages(Part):
    def __init__(self, context: PartContext) -> None:
        self._from_kb = context.settings[LARGE_FROM]
        self._seen = 0

    def on_message(
        self,
        topic: str,
        payload: Payload,
        publisher: Hashable,
        now_ns: int,
        subscription: Subscription | None,
    ) -> None:
        self._seen += len(payload) >= 1000 * self._from_kb

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        section = LargeMessages(from_kb=self._from_kb, seen=self._seen)
        return replace(status, sections={**status.sections, "large": section})


if __name__ == "__main__":
    parser = CommandParser(prog="testudo run")
    add_arguments(parser, (*PART_KINDS, PartKind(make=CountsLargeMessages, options=(LARGE_FROM,))))
    arguments = parser.parse_args()
    sys.exit(arguments.run(arguments))
