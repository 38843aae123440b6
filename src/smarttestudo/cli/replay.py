# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo replay``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any

from smarttestudo import __version__
from smarttestudo.cli.arguments import file_path
from smarttestudo.cli.bag_options import add_recordings, add_several
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.loop_options import add_rules, given_value
from smarttestudo.cli.output import Progress, write_line
from smarttestudo.cli.recordings import (
    AskedOne,
    RecordingCommand,
    each_recording,
    outputs_of_each,
    recordings_asked,
)
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.decision import AnyDecision, about_actions, about_rates
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import column_types
from smarttestudo.domain.recording import RecordingReader, Storage, robots_own
from smarttestudo.domain.units import counted
from smarttestudo.files.outputs import make_folder, require_separate
from smarttestudo.files.whole_file import whole_file
from smarttestudo.incidents.part_kinds import INCIDENT_MEMORY
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.decision_log import decision_log
from smarttestudo.loop.input_log import holds_inputs
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays.expected import read_expected, require_expected
from smarttestudo.replays.outcome import ReplayOutcome, TopicOutcome
from smarttestudo.report.replay_tables import bounds_table, rates_table, volume_table
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import rule_files_named
from smarttestudo.rules.rule_sets import FaultyRulesError, LoadedRules, load_rules

if TYPE_CHECKING:
    from smarttestudo.replays.incidents import IncidentRequest
    from smarttestudo.replays.inputs import InputsOutcome

EXIT_ERROR = 1
_EXPLANATION = (
    "Source is the recording. SmartTestudo is what an operator would have received of the relayed topics, "
    "each at the rate that the rules gave it."
)
_OUTPUTS = {"output": "", "decisions": ".jsonl", "report": ".html", "incidents": "", "expect": ".jsonl"}
"""Options that name what is written, and the suffix of its name where each recording has its own.

What is expected is written with ``--update`` only.
"""


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Run the loop over a recording in virtual time, and write what it relays as a new one."
    )
    add_recordings(
        parser,
        or_else="or what 'testudo run --record-inputs' left, which holds its own rules and gives decisions "
        "only",
    )
    add_rules(parser, required=False)
    parser.add_argument(
        "--output",
        metavar="DIR",
        type=file_path,
        help="the new recording's folder; of several recordings a folder with one of each, as are "
        "--decisions, --report, --incidents and --expect",
    )
    _add_options(parser)
    add_several(parser)
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
    parser.add_argument(
        "--predict",
        metavar="TOPIC",
        type=resolve_topic,
        nargs="+",
        action="extend",
        default=[],
        help="pace as if the operator's end reckoned these topics on (Odometry, transforms, joint states) "
        "where it has no message; the recording holds what was sent",
    )
    parser.add_argument(
        "--decisions", metavar="FILE", type=file_path, help="write the decisions (JSON Lines)"
    )
    parser.add_argument(
        "--expect",
        metavar="FILE",
        type=file_path,
        help="decisions that --update wrote: end with 1 at the first that the rules make otherwise; --output "
        "may be left out",
    )
    parser.add_argument(
        "--update", action="store_true", help="write what is decided now to the file of --expect"
    )
    parser.add_argument(
        "--report", metavar="FILE", type=file_path, help="write a report that shows the replay (HTML)"
    )
    parser.add_argument(
        "--incidents",
        metavar="DIR",
        type=file_path,
        help="write what the rules record (Record), a folder for each incident, into this new folder",
    )
    parser.add_argument(
        "--incident-memory",
        metavar="MB",
        type=partial(given_value, INCIDENT_MEMORY),
        default=DEFAULT_INCIDENT_MEMORY_MB,
        help="memory that the robot would have for what came before an incident (default: %(default)s)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of a table")


def run(arguments: argparse.Namespace) -> int:
    """Replay; 1 if the rules have an error, or a recording could not be replayed."""
    if arguments.update and arguments.expect is None:
        raise UsageError("it needs expected decisions", place="--update", remedy="add --expect FILE")
    asked = recordings_asked(arguments)
    try:
        if len(asked) > 1:
            if arguments.rules is not None:
                load_rules(arguments.rules, profile=_profile(arguments)).refuse_errors()
            asked = _with_outputs(arguments, asked)
        return each_recording(arguments, asked, _Replays())
    except FaultyRulesError as error:
        print_findings(error.rules.errors, error.rules.texts, sys.stderr)
        return EXIT_ERROR


def _with_outputs(arguments: argparse.Namespace, asked: Sequence[AskedOne]) -> list[AskedOne]:
    """``asked`` with what is to be written of each, in the folders that the options name."""
    with_outputs = [*asked]
    for option, suffix in _OUTPUTS.items():
        folder = getattr(arguments, option)
        if folder is None:
            continue
        for number, path in enumerate([*outputs_of_each(asked, folder)]):
            if option != "expect" or arguments.update:
                for parent in reversed(path.relative_to(folder).parents):
                    make_folder(folder / parent)
            with_outputs[number] = {**with_outputs[number], option: path.with_name(path.name + suffix)}
    return with_outputs


class _Replays(RecordingCommand["ReplayOutcome | InputsOutcome"]):
    """Replays of recordings, or of recorded inputs."""

    table = "replays"

    @staticmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> ReplayOutcome | InputsOutcome:
        """Replay one recording, or the inputs of a run."""
        _require_separate(arguments)
        expected = None if arguments.expect is None or arguments.update else read_expected(arguments.expect)
        result, decided = _Replays._replayed(arguments, progress)
        if expected is not None:
            require_expected(expected, decided, arguments.expect)
        elif arguments.update:
            with decision_log(arguments.expect) as write:
                write(decided)
        return result

    @staticmethod
    def _replayed(
        arguments: argparse.Namespace, progress: Progress
    ) -> tuple[ReplayOutcome | InputsOutcome, list[AnyDecision]]:
        """Replay one recording, or the inputs of a run, with the decisions."""
        if holds_inputs(arguments.bag):
            return _replayed_inputs(arguments)
        _require_rules(arguments)
        from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  needs packages a robot lacks
        from smarttestudo.bags.type_definitions import recorded_types  # noqa: PLC0415  as above

        profile = _profile(arguments)
        with open_recording(arguments.bag) as recording:
            channels = robots_own(recording.channels)
            found = recorded_types(channels).without_outputs(arguments.output_topic)
            rules = load_rules(arguments.rules, profile=profile, found=found)
            rules.refuse_errors()
            return _replay(arguments, recording, profile or Profile(), rules, progress)

    def finish(self, arguments: argparse.Namespace) -> None:
        """Say that the decisions are as expected, or written."""
        if arguments.expect is not None and not arguments.json:
            done = "written to" if arguments.update else "as expected in"
            write_line(f"decisions {done} {arguments.expect}")

    def columns(self) -> Mapping[str, Any]:
        """The columns of a topic."""
        return {"topic": str, **column_types(TopicOutcome)}

    def print_text(self, result: ReplayOutcome | InputsOutcome) -> None:
        """The rates, the bounds and the volume, or the decisions over inputs."""
        if not isinstance(result, ReplayOutcome):
            inputs = f"{counted(result.decisions, 'decision')} from {counted(result.inputs, 'input')}"
            write_line(f"{inputs} of {result.duration_s:.1f} s")
            return
        print_table(rates_table(result))
        write_line()
        if any(topic.bounds for topic in result.topics.values()):
            print_table(bounds_table(result))
            write_line()
        print_table(volume_table(result))
        write_line()
        write_line(f"{counted(result.decisions, 'decision')} in {result.wall_seconds:.1f} s")
        for name in result.incidents:
            write_line(f"incident {name}")


def _profile(arguments: argparse.Namespace) -> Profile | None:
    return None if arguments.profile is None else load_profile(arguments.profile)


def _require_rules(arguments: argparse.Namespace) -> None:
    from smarttestudo.bags.bag_files import find_bag_files  # noqa: PLC0415  see measure

    if arguments.report is not None and arguments.output is None:
        raise UsageError("it shows the new recording", place="--report", remedy="add --output")
    for option in ("rules",) if arguments.expect is not None else ("rules", "output"):
        if getattr(arguments, option) is None:
            # Where nothing is, rules would not help.
            find_bag_files(arguments.bag)
            raise UsageError(
                "a replay of a recording needs it", place=f"--{option}", remedy=f"add --{option}"
            )


def _require_separate(arguments: argparse.Namespace) -> None:
    require_separate(
        {f"--{option}": getattr(arguments, option) for option in _OUTPUTS},
        (arguments.bag, arguments.profile, *rule_files_named(arguments.rules or ())),
    )


def _replayed_inputs(arguments: argparse.Namespace) -> tuple[InputsOutcome, list[AnyDecision]]:
    """Decide anew over the inputs that a live run recorded."""
    from smarttestudo.replays.inputs import replay_inputs  # noqa: PLC0415  see measure

    for option in ("rules", "output", "profile", "budget", "report", "incidents"):
        if getattr(arguments, option) is not None:
            cause = f"{arguments.bag} holds recorded inputs, which come with their own rules"
            raise UsageError(cause, place=f"--{option}", remedy="leave it out")
    decisions: list[AnyDecision] = []
    with ExitStack() as opened:
        sinks = _kept_in(decisions, arguments)
        if arguments.decisions is not None:
            sinks.append(opened.enter_context(decision_log(arguments.decisions)))
        return replay_inputs(arguments.bag, partial(_give, sinks)), decisions


_Decided = Callable[[Sequence[AnyDecision]], None]


def _kept_in(decisions: list[AnyDecision], arguments: argparse.Namespace) -> list[_Decided]:
    """Keep decisions where a report or a comparison needs them: a long recording may have a million."""
    return [decisions.extend] if arguments.report is not None or arguments.expect is not None else []


def _give(sinks: Sequence[_Decided], decided: Sequence[AnyDecision]) -> None:
    for sink in sinks:
        sink(decided)


def _replay(
    arguments: argparse.Namespace,
    recording: RecordingReader,
    profile: Profile,
    rules: LoadedRules,
    progress: Progress,
) -> tuple[ReplayOutcome, list[AnyDecision]]:
    from smarttestudo.replays.replay import ReplayRequest, replay  # noqa: PLC0415  see measure

    decisions: list[AnyDecision] = []
    with ExitStack() as opened:
        sinks = _kept_in(decisions, arguments)
        if arguments.report is not None:
            write_report = opened.enter_context(whole_file(arguments.report, "the report"))
        # A report that cannot be made costs neither the recording nor the decisions.
        replaying = opened.enter_context(ExitStack())
        if arguments.decisions is not None:
            sinks.append(replaying.enter_context(decision_log(arguments.decisions)))

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
                    predict=_predicted(arguments.predict, rules.rule_set),
                    logged=partial(_give, sinks),
                    report=report,
                    incidents=_incidents(arguments, rules),
                )
            )
        replaying.close()
        if arguments.report is not None:
            write_report(
                _report(arguments, outcome, decisions, profile=profile, rules=rules, progress=progress)
            )
        return outcome, decisions


def _predicted(topics: Sequence[str], rule_set: RuleSet) -> frozenset[str]:
    """The topics to reckon. Raises ``UsageError`` for one that is not relayed."""
    for topic in topics:
        if topic not in rule_set.relayed:
            raise UsageError(
                f"no rule relays {topic}",
                place="--predict",
                remedy="name topics of a SetFrequency or KeepAtLeast",
            )
    return frozenset(topics)


def _incidents(arguments: argparse.Namespace, rules: LoadedRules) -> IncidentRequest | None:
    from smarttestudo.replays.incidents import IncidentRequest  # noqa: PLC0415  see measure

    if arguments.incidents is None:
        return None
    return IncidentRequest(
        into=arguments.incidents,
        rules_sha256=rules.in_force.sha256,
        memory_mb=arguments.incident_memory,
    )


def _report(
    arguments: argparse.Namespace,
    outcome: ReplayOutcome,
    decisions: Sequence[AnyDecision],
    *,
    profile: Profile,
    rules: LoadedRules,
    progress: Progress,
) -> str:
    """The page on the relayed topics of which there were messages; reads both recordings once more."""
    from smarttestudo.report.bag_report import ReportRequest, bag_report  # noqa: PLC0415  see measure
    from smarttestudo.report.document import render_report  # noqa: PLC0415
    from smarttestudo.report.run_report import Fact  # noqa: PLC0415

    output_topics = {
        topic: relayed.output_topic for topic, relayed in outcome.topics.items() if relayed.messages_in
    }
    request = ReportRequest(
        a=arguments.bag,
        b=arguments.output,
        title=f"Replay of {arguments.bag.resolve().name}",
        explanation=_EXPLANATION,
        mapping=output_topics,
        topics=tuple(output_topics),
        rule_set=rules.rule_set,
        rule_texts=rules.texts,
        decisions=about_rates(decisions),
        actions=about_actions(decisions),
        predict=arguments.predict,
        profile=profile,
        budget_kb_per_s=arguments.budget,
        provenance=(
            Fact(label="SmartTestudo", value=__version__),
            Fact(label="Recording", value=str(arguments.bag)),
            Fact(label="Output recording", value=str(arguments.output)),
        ),
        progress=progress,
    )
    return render_report(bag_report(request))
