# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo replay``: a recording as the operator would have received it."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.adapters.files.decision_log import decision_log
from smarttestudo.adapters.files.input_log import holds_inputs
from smarttestudo.adapters.files.profile import load_profile
from smarttestudo.adapters.files.whole_file import whole_file
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.loop_options import add_rules
from smarttestudo.cli.progress import progress
from smarttestudo.cli.tables import print_table
from smarttestudo.composition.rule_sets import LoadedRules, load_rules
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import RecordingReader, Storage
from smarttestudo.pacing.sample import WhenSlow

if TYPE_CHECKING:
    from smarttestudo.composition.replay_outcome import ReplayOutcome

EXIT_ERROR = 1


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``replay`` to the subcommands."""
    parser = commands.add_parser(
        "replay",
        help="write the recording that an operator would have received under your rules",
        description="Run the loop over a recording in virtual time, and write what it relays as a new one.",
    )
    parser.add_argument(
        "bag",
        metavar="BAG",
        type=Path,
        help="a rosbag2 folder, a .db3 or an .mcap file; or what 'testudo run --record-inputs' left, which "
        "holds its own rules and gives decisions only",
    )
    add_rules(parser, required=False)
    parser.add_argument("--output", metavar="DIR", type=Path, help="the new recording's folder")
    _add_options(parser)
    parser.set_defaults(run=run)


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--storage",
        choices=[storage.value for storage in Storage],
        default=Storage.SQLITE3.value,
        help="file format of the new recording (default: %(default)s)",
    )
    parser.add_argument(
        "--output-topic",
        metavar="NAME",
        default="{topic}",
        help="names of the relayed topics, as in '/testudo{topic}' (default: as they are)",
    )
    parser.add_argument("--decisions", metavar="FILE", type=Path, help="write the decisions (JSON Lines)")
    parser.add_argument(
        "--report", metavar="FILE", type=Path, help="write a page that shows the replay (HTML)"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of a table")


def run(arguments: argparse.Namespace) -> int:
    """Replay; 1 if the rules have an error."""
    if holds_inputs(arguments.bag):
        return _run_inputs(arguments)
    for option in ("rules", "output"):
        if getattr(arguments, option) is None:
            raise UsageError("needed to replay a recording", place=f"--{option}", remedy="see --help")
    from smarttestudo.adapters.rosbag import open_recording  # noqa: PLC0415  needs packages a robot lacks

    profile = None if arguments.profile is None else load_profile(arguments.profile)
    with open_recording(arguments.bag) as recording:
        bag_topics = {channel.topic: channel.type_name for channel in recording.channels}
        rules = load_rules(arguments.rules, profile=profile, bag_topics=bag_topics)
        if rules.errors:
            print_findings(rules.errors, rules.texts, sys.stderr)
            return EXIT_ERROR
        outcome = _replay(arguments, recording, profile or Profile(), rules)
    _print(outcome, as_json=arguments.json)
    return 0


def _run_inputs(arguments: argparse.Namespace) -> int:
    """What a live run saw, decided anew."""
    from smarttestudo.composition.replay_inputs import replay_inputs  # noqa: PLC0415  see run

    for option in ("rules", "output", "profile", "budget", "report"):
        if getattr(arguments, option) is not None:
            cause = f"{arguments.bag} holds recorded inputs, which come with their own rules"
            raise UsageError(cause, place=f"--{option}", remedy="leave it out")
    with ExitStack() as opened:
        decided: Callable[[Sequence[Decision]], None] = _ignore
        if arguments.decisions is not None:
            decided = opened.enter_context(decision_log(arguments.decisions))
        outcome = replay_inputs(arguments.bag, decided)
    if arguments.json:
        print(json.dumps(outcome.to_json(), allow_nan=False))  # noqa: T201
    else:
        print(f"{outcome.decisions:,} decisions from {outcome.inputs:,} inputs in {outcome.duration_s:.1f} s")  # noqa: T201
    for notice in outcome.notices:
        print(f"note: {notice}", file=sys.stderr)  # noqa: T201
    return 0


def _ignore(_: object) -> None:
    """Nobody wants to know."""


def _replay(
    arguments: argparse.Namespace, recording: RecordingReader, profile: Profile, rules: LoadedRules
) -> ReplayOutcome:
    from smarttestudo.composition.replay import ReplayRequest, replay  # noqa: PLC0415  see run

    decisions: list[Decision] = []
    with ExitStack() as opened:
        sinks: list[Callable[[Sequence[Decision]], None]] = []
        if arguments.decisions is not None:
            sinks.append(opened.enter_context(decision_log(arguments.decisions)))
        if arguments.report is not None:
            write_report = opened.enter_context(whole_file(arguments.report, "the report"))
            sinks.append(decisions.extend)

        def decided(new: Sequence[Decision]) -> None:
            for sink in sinks:
                sink(new)

        with progress(f"Replaying {arguments.bag}") as report:
            outcome = replay(
                ReplayRequest(
                    recording=recording,
                    rule_set=rules.rule_set,
                    profile=profile,
                    output=arguments.output,
                    when_slow=WhenSlow(arguments.when_slow),
                    storage=Storage(arguments.storage),
                    output_topic=arguments.output_topic,
                    budget_kb_per_s=arguments.budget,
                    decided=decided,
                    report=report,
                )
            )
        if arguments.report is not None:
            write_report(_report(arguments, outcome, decisions, rules))
        return outcome


def _report(
    arguments: argparse.Namespace, outcome: ReplayOutcome, decisions: Sequence[Decision], rules: LoadedRules
) -> str:
    from smarttestudo.composition.replay_report import ReportRequest, replay_report  # noqa: PLC0415  see run

    with progress("Measuring both recordings") as report:
        return replay_report(
            ReportRequest(
                bag=arguments.bag,
                output=arguments.output,
                monitored={name: topic.monitored_topic for name, topic in outcome.topics.items()},
                decisions=decisions,
                rule_texts=rules.texts,
                report=report,
            )
        )


def _print(outcome: ReplayOutcome, *, as_json: bool) -> None:
    from smarttestudo.cli.replay_tables import rates_table, volume_table  # noqa: PLC0415  see run

    if as_json:
        print(json.dumps(outcome.to_json(), allow_nan=False))  # noqa: T201
    else:
        for table in (rates_table(outcome), volume_table(outcome)):
            print_table(table)
            print()  # noqa: T201
        decisions = "decision" if outcome.decisions == 1 else "decisions"
        print(f"{outcome.decisions:,} {decisions} in {outcome.wall_seconds:.1f} s")  # noqa: T201
    for notice in outcome.notices:
        print(f"note: {notice}", file=sys.stderr)  # noqa: T201
