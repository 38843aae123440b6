# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots that come, leave and change, a line each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from smarttestudo.domain.link import StreamInfo
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid


@dataclass(slots=True)
class _Robot:
    """``boots`` are the runs of its end that are connected; ``types`` are those of its topics."""

    boots: set[str] = field(default_factory=set)
    types: dict[str, str] = field(default_factory=dict)


class ArrivalLog:
    """Given the events of the operator's end, in order, tells ``say`` what a person would want to know."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._robots: dict[str, _Robot] = {}

    def handle(self, event: LinkEvent) -> None:
        robot = self._robots.setdefault(event.robot, _Robot())
        match event:
            case RobotPresence():
                self._note_presence(robot, event)
            case StreamSaid(info=StreamInfo() as stream):
                before = robot.types.get(stream.topic)
                robot.types[stream.topic] = stream.type_name
                if before is None:
                    self._say(f"{event.robot}: sends {stream.topic} ({stream.type_name})")
                elif before != stream.type_name:
                    self._say(f"{event.robot}: {stream.topic} is {stream.type_name} now, not {before}")

    def _note_presence(self, robot: _Robot, event: RobotPresence) -> None:
        before = len(robot.boots)
        (robot.boots.add if event.is_present else robot.boots.discard)(event.boot)
        count = len(robot.boots)
        if count == before:
            return
        if not count:
            self._say(f"{event.robot}: not connected any more")
        elif count == 1:
            self._say(f"{event.robot}: connected" if not before else f"{event.robot}: one robot of this name")
        else:
            self._say(f"{event.robot}: {count} robots of this name are connected")
