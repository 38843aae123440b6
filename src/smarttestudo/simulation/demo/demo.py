# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo: a simulated mission, recorded, replayed under rules, and shown."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo import __version__
from smarttestudo.accuracy.comparison import AccuracyRequest, NamedRules, View
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.record import to_json
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.decision_log import decision_log, read_decisions
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.report.bag_report import ReportRequest, bag_report
from smarttestudo.report.document import render_report
from smarttestudo.report.run_report import Fact, RunReport
from smarttestudo.simulation.demo import thesis
from smarttestudo.simulation.demo.folder import (
    ACCURACY,
    ADAPTIVE,
    BASELINE,
    DECISIONS,
    LOGS,
    MARKER,
    PREDICTED,
    REPORT,
    RULES,
    THESIS,
    WITHIN,
    DemoRequest,
    DemoRules,
    demo_folder,
    put_rules,
)
from smarttestudo.simulation.demo.live import record_live
from smarttestudo.simulation.mission import bytes_per_second, record_mission, route_of
from smarttestudo.simulation.route import Route, Tour
from smarttestudo.simulation.warehouse import warehouse

_MADE = frozenset(
    {BASELINE, ADAPTIVE, DECISIONS, REPORT, ACCURACY, RULES, WITHIN, PREDICTED, MARKER, *LOGS, THESIS}
)
_FILLED = {THESIS: thesis.file_names()}
_TITLE = "A TurtleBot3 patrols a warehouse"
_EXPLANATION = (
    "Source is everything that the robot published. SmartTestudo is what an operator received of it while "
    "rules about the robot's own state gave each topic its rate."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoOutcome:
    """The report on both runs, the number of decisions, and what was odd, a line each."""

    report: RunReport
    decisions: int
    notices: tuple[str, ...]


def run_demo(request: DemoRequest) -> DemoOutcome:
    """Write both recordings, the rules, the decisions and the report into a new ``request.out``.

    Rules that somebody edited there after a former demo stay, and are those of this one; so does whatever
    else no demo made.

    Raises:
        DemoFolderError: the folder may not be replaced or cannot be written.
        RuleFileError: the edited rules cannot be used.
        MissionError: the mission cannot be read or driven.
        RecordingError: a recording cannot be written.
    """
    route = route_of(request.mission)
    also_write = thesis.thesis_writer(request.when_slow) if request.with_thesis else None
    needed_bytes = round(bytes_per_second(full_images=request.full_images) * request.seconds)
    with demo_folder(request.out, needed_bytes=needed_bytes, made=_MADE, filled=_FILLED) as folder:
        rules = put_rules(folder, request.out)
        bounding = [put_rules(folder, request.out, name) for name in (WITHIN, PREDICTED)]
        if request.robot is None:
            decisions, notices = _in_virtual_time(request, folder, rules, route)
        else:
            with request.progress("Driving the patrol") as report_share:
                notices = record_live(request, folder, request.robot, report_share)
            decisions = _recorded_decisions(folder)
        compared = _compared(request, folder, rules, bounding)
        report = _write_report(request, folder, rules, decisions, compared)
        if also_write is not None:
            also_write(report, folder / THESIS, folder / BASELINE, rules.rule_set)
        (folder / MARKER).write_text(json.dumps(_settings(request), indent=2) + "\n", "utf-8")
    return DemoOutcome(
        report=report,
        decisions=len(decisions),
        notices=(*(run.notice for run in (rules, *bounding) if run.notice), *notices),
    )


def _in_virtual_time(
    request: DemoRequest, folder: Path, rules: DemoRules, route: Route | Tour
) -> tuple[Sequence[Decision], tuple[str, ...]]:
    """Record the mission, and replay it under the rules; decisions and what was lost or odd."""
    with request.progress("Driving the patrol") as report:
        record_mission(
            folder / BASELINE,
            route=route,
            seconds=request.seconds,
            seed=request.seed,
            full_images=request.full_images,
            report=report,
        )
    decisions: list[Decision] = []
    with (
        request.progress("Replaying it under the rules") as report,
        decision_log(folder / DECISIONS) as log,
        open_recording(folder / BASELINE) as recording,
    ):

        def decided(new: Sequence[Decision]) -> None:
            decisions.extend(new)
            log(new)

        outcome = replay(
            ReplayRequest(
                recording=recording,
                rule_set=rules.rule_set,
                output=folder / ADAPTIVE,
                when_slow=request.when_slow,
                decided=decided,
                report=report,
            )
        )
    return decisions, outcome.notices


def _recorded_decisions(folder: Path) -> Sequence[Decision]:
    """The decisions of a runtime, timed from the start of what was recorded.

    What the runtime planned before that held then already.
    """
    with open_recording(folder / BASELINE) as recording:
        start_ns = recording.start_ns
    return [
        replace(decision, t_s=max(decision.stamp_ns - start_ns, 0) / NS_PER_S)
        for decision in read_decisions(folder / DECISIONS)
    ]


def _compared(
    request: DemoRequest, folder: Path, rules: DemoRules, bounding: Sequence[DemoRules]
) -> AccuracyRequest | None:
    """The baseline at fixed rates, under the rules, and under those with bounds.

    With whole images it would read them again and again, to say the same as without.
    """
    if request.full_images:
        return None
    within, predicted = bounding
    is_replay = request.robot is None
    shown = ((rules, View.HOLD), (within, View.HOLD), (within, View.RECKONED), (predicted, View.RECKONED))
    return AccuracyRequest(
        bag=folder / BASELINE,
        rules=[NamedRules(name=Path(one.name).stem, rule_set=one.rule_set, view=view) for one, view in shown],
        progress=request.progress,
        called=BASELINE,
        received=folder / ADAPTIVE if is_replay and request.when_slow is WhenSlow.PASS else None,
    )


def _write_report(
    request: DemoRequest,
    folder: Path,
    rules: DemoRules,
    decisions: Sequence[Decision],
    compared: AccuracyRequest | None,
) -> RunReport:
    """Measure both recordings as they lie on disk, and show them."""
    report = bag_report(
        ReportRequest(
            a=folder / BASELINE,
            b=folder / ADAPTIVE,
            title=_TITLE,
            explanation=_EXPLANATION,
            rule_set=rules.rule_set,
            rule_texts={RULES: rules.text},
            decisions=decisions,
            # The zones that the report shows are those of the rules.
            floor_plan=replace(warehouse(), zones=()),
            provenance=_provenance(request),
            progress=request.progress,
            called=lambda path: str(request.out / path.name),
            compared=compared,
        )
    )
    if report.accuracy is not None:
        (folder / ACCURACY).write_text(json.dumps(to_json(report.accuracy), indent=2) + "\n", "utf-8")
    (folder / REPORT).write_text(render_report(report), "utf-8")
    return report


def _provenance(request: DemoRequest) -> tuple[Fact, ...]:
    facts = {
        "SmartTestudo": __version__,
        "Source recording": BASELINE,
        "SmartTestudo recording": ADAPTIVE,
        "Length": f"{request.seconds:g} s",
        "Time": _time(request),
        "Seed": str(request.seed),
        "Camera frames": "whole" if request.full_images else "small, with declared sizes",
        "Where a target is above its source": request.when_slow.value,
    }
    return tuple(Fact(label=label, value=value) for label, value in facts.items())


def _time(request: DemoRequest) -> str:
    if request.robot is None:
        return "virtual"
    return "real, over ROS 2, by a robot with physics" if request.physics else "real, over ROS 2"


def _settings(request: DemoRequest) -> dict[str, object]:
    return {
        "smarttestudo": __version__,
        "seconds": request.seconds,
        "seed": request.seed,
        "full_images": request.full_images,
        "when_slow": request.when_slow.value,
        "live": request.robot is not None,
        "physics": request.physics,
        "mission": None if request.mission is None else request.mission.read_text("utf-8-sig"),
    }
