# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The machine and the link, as rules read them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.domain.link import LinkState
from smarttestudo.domain.names import LINK, MACHINE, SOURCES
from smarttestudo.domain.observation import VitalsMeasured
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.texts import SayOnce
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.loop.inputs import ChangeInput
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.machine import MachineReader, MachineVitals
from smarttestudo.robot.option import Option
from smarttestudo.robot.part import Part, PartContext, PartKind, RunView

if TYPE_CHECKING:
    from smarttestudo.domain.link import OutgoingLink

PERIOD_S = 1.0
_DECIMALS = 3
_WITHOUT_LINK = "the rules read @link, which is unknown without a link: --link or --link-listen makes one"


class LinkVitals:
    """Values of a link that rules read."""

    def __init__(self) -> None:
        self._sent: tuple[int, int] | None = None
        """How much was sent, and when, as of the last time."""

    def read(self, state: LinkState, now_ns: int, names: Collection[str]) -> dict[str, float | None]:
        """The values of these properties at ``now_ns``, a steady time; ``None`` where one is unknown."""
        before, self._sent = self._sent, (state.sent_bytes, now_ns)
        is_there = state.is_connected
        values = {
            "capacity": state.capacity_kb_per_s if is_there else None,
            "round_trip": state.round_trip_ms if is_there else None,
            "used": _used_percent(state, before, now_ns) if is_there else None,
            "connected": float(is_there),
            "age": state.silent_s,
        }
        return {name: _rounded(values[name]) for name in names if name in values}


def _used_percent(state: LinkState, before: tuple[int, int] | None, now_ns: int) -> float | None:
    if before is None or not state.capacity_kb_per_s or now_ns <= before[1]:
        return None
    sent_kb_per_s = (state.sent_bytes - before[0]) / BYTES_PER_KB * NS_PER_S / (now_ns - before[1])
    return min(100 * sent_kb_per_s / state.capacity_kb_per_s, 100.0)


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, _DECIMALS)


class VitalsPart(Part):
    """Gives the loop what its rules read of the machine and of the link, once a second."""

    poll_s = PERIOD_S

    def __init__(self, robot: Robot, machine: MachineVitals, link: OutgoingLink | None) -> None:
        self._robot = robot
        self._machine = MachineReader(machine)
        self._link = link
        self._link_vitals = LinkVitals()
        self._warn_once = SayOnce(robot.log.warning)
        self._names: Mapping[str, frozenset[str]] = {}
        self._run: RunView | None = None

    def begin(self, run: RunView) -> None:
        self._run = run

    def follow(self, rules: LiveRules, now_ns: int) -> None:  # noqa: ARG002 - a part's
        """Read from now on what these rules do."""
        before = self._names
        self._names = {
            source: names
            for source in SOURCES
            if (names := frozenset(one.property for one in rules.rule_set.signals if one.topic == source))
        }
        if MACHINE in before and MACHINE not in self._names:
            # What is measured over a second does not reach over a pause.
            self._machine.ask(())
        if LINK not in self._names:
            self._link_vitals = LinkVitals()
        elif self._link is None:
            self._warn_once(_WITHOUT_LINK)

    def poll(self) -> None:
        """Give the loop what was read; nothing where rules read nothing."""
        if MACHINE in self._names:
            if values := self._machine.take():
                self._give(MACHINE, values)
            self._machine.ask(self._names[MACHINE])
        if LINK in self._names and self._link is not None:
            now_ns = self._robot.steady_ns()
            self._give(LINK, self._link_vitals.read(self._link.state, now_ns, self._names[LINK]))

    def _give(self, source: str, values: Mapping[str, float | None]) -> None:
        if self._run is not None:
            change = VitalsMeasured(source=source, values=values)
            self._run.give(ChangeInput(stamp_ns=self._robot.now_ns(), change=change))

    def close(self) -> None:
        self._machine.close()


def vitals_part(incidents: Option[Path | None]) -> PartKind:
    """The part of a run in which ``incidents`` names the folder whose disk counts."""

    def make(context: PartContext) -> Part:
        disk = context.settings[incidents] or Path()
        return VitalsPart(context.robot, MachineVitals(disk), context.link)

    return PartKind(make=make)
