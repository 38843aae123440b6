# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo replay``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING

from smarttestudo.bags.comparison import change_percent
from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.loop_options import add_rules, given_value
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.progress import progress
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import RecordingReader, Storage
from smarttestudo.domain.units import counted
from smarttestudo.files.outputs import require_separate
from smarttestudo.files.whole_file import whole_file
from smarttestudo.incidents.live_incidents import INCIDENT_MEMORY
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.decision_log import decision_log
from smarttestudo.loop.input_log import holds_inputs
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays.outcome import ReplayOutcome, TopicOutcome
from smarttestudo.report.comparison_tables import DECLARED
from smarttestudo.report.table import Align, Column, Number, Row, Table, Text
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import rule_files_named
from smarttestudo.rules.rule_sets import LoadedRules, load_rules

if TYPE_CHECKING:
    from smarttestudo.replays.incidents import IncidentRequest
    from smarttestudo.replays.outcome import ReplayOutcome


_TOPIC = Column(heading="Topic", align=Align.LEFT)
_RATES_NOTE = (
    "Hz: (n − 1) / (last − first). Error: the mean against the lesser of target and source at each time. "
    "Target and error are weighted by time."
)
_BOUNDS_NOTE = (
    "Bound and worst are in the property's unit: m, degrees, or the field's own. Worst is how far the "
    "operator's picture was off after any message of the source; broken counts the messages after which it "
    "was more than the bound."
)
_FRAMES_NOTE = "Transforms have the rate for each child frame, and so the means over the frames stand here."
_DECLARED_NOTE = "declared: the size that the recording declares for its messages, not the one it holds."


def rates_table(outcome: ReplayOutcome) -> Table:
    """Table of each relayed topic's messages in and out, and how near its rate came to its target."""
    repeats = any(topic.repeated for topic in outcome.topics.values())
    frames = any((topic.frames or 0) > 1 for topic in outcome.topics.values())
    return Table(
        title="Rates",
        columns=(
            _TOPIC,
            Column(heading="In"),
            Column(heading="Out"),
            *((Column(heading="Repeated"),) if repeats else ()),
            Column(heading="Source", unit="Hz"),
            Column(heading="Target", unit="Hz"),
            Column(heading="Mean", unit="Hz"),
            Column(heading="Error", unit="%"),
        ),
        rows=tuple(_rates(name, topic, repeats=repeats) for name, topic in outcome.topics.items()),
        footnotes=(_RATES_NOTE, _FRAMES_NOTE) if frames else (_RATES_NOTE,),
    )


def bounds_table(outcome: ReplayOutcome) -> Table:
    """How each bound of the receiver's picture was kept."""
    rows = tuple(
        Row(
            cells=(
                Text(name),
                Text(prop),
                Number(one.bound, decimals=3),
                Number(one.worst, decimals=3),
                Number(one.broken, decimals=0),
            )
        )
        for name, topic in outcome.topics.items()
        for prop, one in topic.bounds.items()
    )
    return Table(
        title="Bounds",
        columns=(
            _TOPIC,
            Column(heading="Property", align=Align.LEFT),
            Column(heading="Bound"),
            Column(heading="Worst"),
            Column(heading="Broken"),
        ),
        rows=rows,
        footnotes=(_BOUNDS_NOTE,),
    )


def volume_table(outcome: ReplayOutcome) -> Table:
    """How much each relayed topic carried in and out, and the sum; declared sizes are labelled."""
    topics = outcome.topics
    declared = any(topic.declared for topic in topics.values())
    total = Row(
        cells=(
            Text("All"),
            *_volumes(
                sum(topic.in_kb for topic in topics.values()), sum(topic.out_kb for topic in topics.values())
            ),
            *((Text(""),) if declared else ()),
        ),
        is_total=True,
    )
    return Table(
        title="Volume",
        columns=(
            _TOPIC,
            Column(heading="In", unit="KB"),
            Column(heading="Out", unit="KB"),
            Column(heading="Change", unit="%"),
            *((Column(heading="Sizes", align=Align.LEFT),) if declared else ()),
        ),
        rows=(*(_volume(name, topic, declared=declared) for name, topic in topics.items()), total),
        footnotes=(_DECLARED_NOTE,) if declared else (),
    )


def _rates(name: str, topic: TopicOutcome, *, repeats: bool) -> Row:
    return Row(
        cells=(
            Text(name),
            Number(topic.messages_in, decimals=0),
            Number(topic.messages_out, decimals=0),
            *((Number(topic.repeated, decimals=0),) if repeats else ()),
            Number(topic.source_hz),
            Number(topic.target_hz),
            Number(topic.mean_hz),
            Number(topic.error_percent, signed=True),
        )
    )


def _volume(name: str, topic: TopicOutcome, *, declared: bool) -> Row:
    label = (Text(DECLARED if topic.declared else ""),) if declared else ()
    return Row(cells=(Text(name), *_volumes(topic.in_kb, topic.out_kb), *label))


def _volumes(in_kb: float, out_kb: float) -> tuple[Number, Number, Number]:
    change = Number(change_percent(in_kb, out_kb), decimals=1, signed=True)
    return Number(in_kb, decimals=1), Number(out_kb, decimals=1), change


EXIT_ERROR = 1
_OUTPUTS = ("--output", "--decisions", "--report", "--incidents")


def add_arguments(parser: CommandParser) -> None:
    """Add the arguments of ``testudo replay``."""
    parser.description = (
        "Run the loop over a recording in virtual time, and write what it relays as a new one."
    )
    parser.add_argument(
        "bag",
        metavar="BAG",
        type=file_path,
        help="a rosbag2 folder, a .db3 or an .mcap file; or what 'testudo run --record-inputs' left, which "
        "holds its own rules and gives decisions only",
    )
    add_rules(parser, required=False)
    parser.add_argument("--output", metavar="DIR", type=file_path, help="the new recording's folder")
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
    parser.add_argument(
        "--predict",
        metavar="TOPIC",
        type=resolve_topic,
        nargs="+",
        default=(),
        help="pace as if the operator's end reckoned these topics on (Odometry, transforms, joint states) "
        "where it has no message; the recording holds what was sent",
    )
    parser.add_argument(
        "--decisions", metavar="FILE", type=file_path, help="write the decisions (JSON Lines)"
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
    """Replay; 1 if the rules have an error."""
    _require_separate(arguments)
    if holds_inputs(arguments.bag):
        return _run_inputs(arguments)
    for option in ("rules", "output"):
        if getattr(arguments, option) is None:
            raise UsageError(
                "a replay of a recording needs it", place=f"--{option}", remedy=f"add --{option}"
            )
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  needs packages a robot lacks

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


def _require_separate(arguments: argparse.Namespace) -> None:
    require_separate(
        {option: getattr(arguments, option.removeprefix("--")) for option in _OUTPUTS},
        (arguments.bag, arguments.profile, *rule_files_named(arguments.rules or ())),
    )


def _run_inputs(arguments: argparse.Namespace) -> int:
    """Decide anew over the inputs that a live run recorded."""
    from smarttestudo.replays.inputs import replay_inputs  # noqa: PLC0415  see run

    for option in ("rules", "output", "profile", "budget", "report", "incidents"):
        if getattr(arguments, option) is not None:
            cause = f"{arguments.bag} holds recorded inputs, which come with their own rules"
            raise UsageError(cause, place=f"--{option}", remedy="leave it out")
    with ExitStack() as opened:
        decided: Callable[[Sequence[Decision]], None] = _ignore
        if arguments.decisions is not None:
            decided = opened.enter_context(decision_log(arguments.decisions))
        outcome = replay_inputs(arguments.bag, decided)
    if arguments.json:
        print(json_text(outcome.to_json()))  # noqa: T201
    else:
        inputs = f"{counted(outcome.decisions, 'decision')} from {counted(outcome.inputs, 'input')}"
        print(f"{inputs} in {outcome.duration_s:.1f} s")  # noqa: T201
    for notice in outcome.notices:
        print(f"note: {notice}", file=sys.stderr)  # noqa: T201
    return 0


def _ignore(_: object) -> None:
    """Do nothing."""


def _replay(
    arguments: argparse.Namespace, recording: RecordingReader, profile: Profile, rules: LoadedRules
) -> ReplayOutcome:
    from smarttestudo.replays.replay import ReplayRequest, replay  # noqa: PLC0415  see run

    decisions: list[Decision] = []
    with ExitStack() as opened:
        sinks: list[Callable[[Sequence[Decision]], None]] = []
        if arguments.report is not None:
            write_report = opened.enter_context(whole_file(arguments.report, "the report"))
            sinks.append(decisions.extend)
        # A report that cannot be made costs neither the recording nor the decisions.
        replaying = opened.enter_context(ExitStack())
        if arguments.decisions is not None:
            sinks.append(replaying.enter_context(decision_log(arguments.decisions)))

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
                    predict=_predicted(arguments.predict, rules.rule_set),
                    decided=decided,
                    report=report,
                    incidents=_incidents(arguments, rules),
                )
            )
        replaying.close()
        if arguments.report is not None:
            write_report(_report(arguments, outcome, decisions, profile, rules))
        return outcome


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
    from smarttestudo.replays.incidents import IncidentRequest  # noqa: PLC0415  see run

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
    decisions: Sequence[Decision],
    profile: Profile,
    rules: LoadedRules,
) -> str:
    from smarttestudo.report.document import render_report  # noqa: PLC0415
    from smarttestudo.report.replay_report import replay_report  # noqa: PLC0415  see run

    return render_report(
        replay_report(
            bag=arguments.bag,
            output=arguments.output,
            outcome=outcome,
            decisions=decisions,
            predict=arguments.predict,
            profile=profile,
            budget_kb_per_s=arguments.budget,
            rules=rules,
            progress=progress,
        )
    )


def _print(outcome: ReplayOutcome, *, as_json: bool) -> None:

    if as_json:
        print(json_text(outcome.to_json()))  # noqa: T201
    else:
        tables = [rates_table(outcome), volume_table(outcome)]
        if any(topic.bounds for topic in outcome.topics.values()):
            tables.insert(1, bounds_table(outcome))
        for table in tables:
            print_table(table)
            print()  # noqa: T201
        print(f"{counted(outcome.decisions, 'decision')} in {outcome.wall_seconds:.1f} s")  # noqa: T201
        for name in outcome.incidents:
            print(f"incident {name}")  # noqa: T201
    for notice in outcome.notices:
        print(f"note: {notice}", file=sys.stderr)  # noqa: T201
