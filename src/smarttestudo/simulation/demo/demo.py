# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo: a simulated mission, recorded, replayed under rules, and shown."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo import __version__
from smarttestudo.accuracy.comparison import AccuracyComparison, View
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.accuracy.recorded_comparison import AccuracyRequest, NamedRules
from smarttestudo.bags.comparison import Comparison
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.record import to_json
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.decision_log import decision_log, read_decisions
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays.outcome import ReplayOutcome
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.report.bag_report import Progress, ReportRequest, bag_report
from smarttestudo.report.document import render_report
from smarttestudo.report.run_report import Fact, RunReport
from smarttestudo.simulation.demo import thesis
from smarttestudo.simulation.demo.folder import (
    MARKER,
    PREDICTED,
    RULES,
    WITHIN,
    DemoRules,
    demo_folder,
    put_rules,
)
from smarttestudo.simulation.demo.live import LOGS, LiveDemoRequest, record_live
from smarttestudo.simulation.mission import bytes_per_second, record_mission, route_of
from smarttestudo.simulation.route import Route, Tour
from smarttestudo.simulation.warehouse import warehouse

BASELINE = "baseline"
ADAPTIVE = "adaptive"
DECISIONS = "decisions.jsonl"
REPORT = "report.html"
ACCURACY = "accuracy.json"
THESIS = thesis.FOLDER
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
class DemoRequest:
    """How long a mission, with which noise, and into which folder.

    ``full_images`` asks for whole camera frames, about 0.2 GB each second, instead of small ones. With a
    ``robot``, the node that records, the mission takes place in real time on a real ROS graph, with
    ``physics`` by a robot that has masses and forces. ``mission`` is the file of a tour; without one the
    robot drives the patrol of the thesis. ``with_thesis`` asks for the tables and figures of the thesis, too.
    """

    out: Path
    seconds: float
    seed: int
    full_images: bool
    when_slow: WhenSlow
    progress: Progress
    robot: Robot | None = None
    mission: Path | None = None
    physics: bool = False
    with_thesis: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoOutcome:
    """Both runs compared, what the operator lost, the number of decisions, and what was odd, a line each.

    ``accuracy`` has the same drive at fixed rates and under rules with bounds.
    """

    comparison: Comparison
    loss: LossReport | None
    accuracy: AccuracyComparison | None
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
    also_write = thesis.thesis_writer() if request.with_thesis else None
    needed_bytes = round(bytes_per_second(full_images=request.full_images) * request.seconds)
    with demo_folder(request.out, needed_bytes=needed_bytes, made=_MADE, filled=_FILLED) as folder:
        rules = put_rules(folder, request.out)
        bounding = [put_rules(folder, request.out, name) for name in (WITHIN, PREDICTED)]
        if request.robot is None:
            decisions, notices = _in_virtual_time(request, folder, rules, route)
        else:
            notices = _in_real_time(request, folder, request.robot)
            decisions = _recorded_decisions(folder)
        compared = _compared(request, folder, rules, bounding)
        report = _write_report(request, folder, rules, decisions, compared)
        if also_write is not None:
            also_write(report, folder / THESIS)
        (folder / MARKER).write_text(json.dumps(_settings(request), indent=2) + "\n", "utf-8")
    return DemoOutcome(
        comparison=report.comparison,
        loss=report.loss,
        accuracy=report.accuracy,
        decisions=len(decisions),
        notices=(*_rule_notices(request, (rules, *bounding)), *notices),
    )


def _rule_notices(request: DemoRequest, rules: Sequence[DemoRules]) -> tuple[str, ...]:
    """Where rules are not the demo's own, that they are not."""
    return tuple(
        f"{request.out / one.name} was edited: kept and used; without it the demo takes its own rules"
        for one in rules
        if one.are_edited
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
    outcome, decisions = _replay(request, folder, rules)
    return decisions, outcome.notices


def _in_real_time(request: DemoRequest, folder: Path, robot: Robot) -> tuple[str, ...]:
    """Record the mission while it is driven under the runtime; what was left out."""
    with request.progress("Driving the patrol") as report:
        return record_live(
            LiveDemoRequest(
                baseline=folder / BASELINE,
                adaptive=folder / ADAPTIVE,
                rules=folder / RULES,
                decisions=folder / DECISIONS,
                logs=folder,
                seconds=request.seconds,
                seed=request.seed,
                full_images=request.full_images,
                when_slow=request.when_slow,
                mission=request.mission,
                physics=request.physics,
            ),
            robot,
            report,
        )


def _recorded_decisions(folder: Path) -> Sequence[Decision]:
    """The decisions of a runtime, timed from the start of what was recorded."""
    with open_recording(folder / BASELINE) as recording:
        start_ns = recording.start_ns
    return [_since(start_ns, decision) for decision in read_decisions(folder / DECISIONS)]


def _since(start_ns: int, decision: Decision) -> Decision:
    """The decision timed from the recording's start; what the runtime planned before held then already."""
    return replace(decision, t_s=max(decision.stamp_ns - start_ns, 0) / NS_PER_S)


def _replay(request: DemoRequest, folder: Path, rules: DemoRules) -> tuple[ReplayOutcome, Sequence[Decision]]:
    """The baseline under the rules."""
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
    return outcome, decisions


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
            provenance=tuple(_provenance(request)),
            progress=request.progress,
            called=lambda path: str(request.out / path.name),
            compared=compared,
        )
    )
    if report.accuracy is not None:
        (folder / ACCURACY).write_text(json.dumps(to_json(report.accuracy), indent=2) + "\n", "utf-8")
    (folder / REPORT).write_text(render_report(report), "utf-8")
    return report


def _provenance(request: DemoRequest) -> list[Fact]:
    return [
        Fact(label="SmartTestudo", value=__version__),
        Fact(label="Source recording", value=BASELINE),
        Fact(label="SmartTestudo recording", value=ADAPTIVE),
        Fact(label="Length", value=f"{request.seconds:g} s"),
        Fact(label="Time", value=_time(request)),
        Fact(label="Seed", value=str(request.seed)),
        Fact(label="Camera frames", value="whole" if request.full_images else "small, with declared sizes"),
        Fact(label="Where a target is above its source", value=request.when_slow.value),
    ]


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
