# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo incidents``, of a folder and, with ``--connect``, of robots over their links."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import chain
from typing import TYPE_CHECKING, TextIO

from smarttestudo.bags.incident_record import missing_text, signal_texts
from smarttestudo.cli.arguments import file_path
from smarttestudo.cli.bag_options import print_notice, print_notices
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.link_options import add_connect, connect_options, warn
from smarttestudo.cli.output import write_line, write_lines, written_over
from smarttestudo.cli.robots import add_robot
from smarttestudo.cli.tables import print_table
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.domain.errors import LinkError, RecordingError, UsageError, missing_package
from smarttestudo.domain.incident import (
    FetchProgress,
    IncidentRecord,
    IncidentTopic,
    OnProgress,
    RemoteIncident,
    RemoteIncidents,
    incident_to_json,
)
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.record import to_json
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB, NS_PER_S, counted, utc_time
from smarttestudo.incidents.store import IncidentStore, StoredIncident
from smarttestudo.link.zenoh import open_link_incidents
from smarttestudo.report.table import WHOLE, Column, Table, decimals

if TYPE_CHECKING:
    from smarttestudo.cli.commands import Subcommands


_EXIT_STOPPED = 1
_EXIT_SILENT = 1
_FOUND_WITHIN_S = 10.0
_KNOWN_WITHIN_S = 3.0
_POLL_S = 0.1
_SETTLED_S = 0.5
_NAMED = 8


def list_remote(arguments: argparse.Namespace) -> int:
    """The incidents of a robot, or of all that are heard and answer, one line each."""
    with stop_signals() as stopped, _opened(arguments) as incidents:
        robots = _heard(incidents, stopped, arguments)
        if arguments.robot is not None:
            robots = [_chosen(robots, arguments)]
        answers = {robot: _listed_by(incidents, robot, is_alone=len(robots) == 1) for robot in robots}
    lists = {robot: answer for robot, answer in answers.items() if answer is not None}
    if not lists:
        return _EXIT_SILENT
    found = [one for of_robot in lists.values() for one in of_robot]
    if arguments.json:
        write_line(json_text([_remote_json(one) for one in found]))
    elif found:
        print_table(incident_table(found))
    else:
        write_line(f"no incidents on {', '.join(lists)}")
    return 0


def _listed_by(incidents: RemoteIncidents, robot: str, *, is_alone: bool) -> Sequence[RemoteIncident] | None:
    """The incidents of a robot, ``None`` where it does not answer: that is said, or raised if it is alone."""
    try:
        return incidents.list(robot)
    except LinkError as error:
        if is_alone:
            raise
        warn(f"{robot}: {error}")
        return None


def fetch(arguments: argparse.Namespace) -> int:
    """Fetch one incident, or go on with it."""
    with stop_signals() as stopped, _opened(arguments) as incidents:
        robot = _chosen(_heard(incidents, stopped, arguments), arguments)
        last = FetchProgress(got_bytes=0, total_bytes=0)

        def note(progress: FetchProgress) -> None:
            nonlocal last
            last = progress
            show(progress)

        with progress_line() as show:
            path = incidents.fetch(robot, arguments.name, arguments.output, note, stopped)
    if arguments.json:
        record = {
            "robot": robot,
            "incident": arguments.name,
            "path": None if path is None else str(path),
            "got_bytes": last.got_bytes,
            "total_bytes": last.total_bytes,
        }
        write_line(json_text(record))
    elif path is not None:
        write_line(f"{last.total_bytes / BYTES_PER_MB:.2f} MB in {path}")
    else:
        write_line(f"stopped at {_share(last)}; the same command goes on from there", sys.stderr)
    return _EXIT_STOPPED if path is None else 0


@contextmanager
def _opened(arguments: argparse.Namespace) -> Iterator[RemoteIncidents]:
    options = connect_options(arguments)
    if options is None:
        raise UsageError("no robot is named", place="--connect", remedy="add --connect ENDPOINT")
    with open_link_incidents(options, warn) as incidents:
        yield incidents


def _heard(
    incidents: RemoteIncidents, stopped: Callable[[], bool], arguments: argparse.Namespace
) -> Sequence[str]:
    """The robots that are there, as soon as there is the one that is asked for, or all are known."""
    end_s = time.monotonic() + _FOUND_WITHIN_S
    while not stopped():
        robots = incidents.robots(_POLL_S)
        if robots and arguments.robot is None:
            return _all_heard(incidents)
        if arguments.robot in robots:
            return robots
        if time.monotonic() > end_s:
            if robots:
                return robots
            break
        time.sleep(_POLL_S)
    raise LinkError(
        incidents.problem or "no robot is heard",
        place=", ".join(arguments.connect),
        remedy="start 'testudo run --link' on the robot, and check that it reaches the same place",
    )


def _all_heard(incidents: RemoteIncidents) -> Sequence[str]:
    """The robots, once no further one is heard of for a moment: a router may know some of them later."""
    robots: Sequence[str] = ()
    now = incidents.robots(_KNOWN_WITHIN_S)
    while now != robots:
        robots = now
        time.sleep(_SETTLED_S)
        now = incidents.robots(0)
    return robots


def _chosen(robots: Sequence[str], arguments: argparse.Namespace) -> str:
    names, place = ", ".join(robots[:_NAMED]), ", ".join(arguments.connect)
    if arguments.robot is None and len(robots) > 1:
        raise UsageError(f"several robots are heard: {names}", place=place, remedy="name one with --robot")
    if arguments.robot not in (None, *robots):
        cause = f"there is no robot {arguments.robot!r}, but {names}"
        raise UsageError(cause, place=place, remedy="name one of these with --robot")
    return robots[0] if arguments.robot is None else str(arguments.robot)


@contextmanager
def progress_line(stream: TextIO | None = None) -> Iterator[OnProgress]:
    """On a terminal (default: standard error) one line that changes, erased at the end; silent in a pipe."""
    stream = stream or sys.stderr
    if not stream.isatty():
        yield lambda _: None
        return
    write = written_over(stream)
    try:
        yield lambda progress: write(progress_text(progress))
    finally:
        write("")


def progress_text(progress: FetchProgress) -> str:
    """How far a fetch is, in words."""
    words = [f"{_share(progress)} of {progress.total_bytes / BYTES_PER_MB:.2f} MB"]
    if progress.waits_for is not None:
        words.append(f"waits for {progress.waits_for}")
    else:
        words.append(f"{progress.rate_bytes_per_s / BYTES_PER_KB:.0f} KB/s")
    if progress.level_hz == math.inf:
        words.append("all small messages are there")
    elif progress.level_hz is not None:
        words.append(f"skeleton of {progress.level_hz:g} Hz is there")
    return ", ".join(words)


def _share(progress: FetchProgress) -> str:
    return f"{100 * progress.got_bytes / max(progress.total_bytes, 1):.0f} %"


def _remote_json(one: RemoteIncident) -> dict[str, object]:
    return {"incident": one.name, "read": one.is_read, **to_json(one)}


def incident_table(incidents: Sequence[RemoteIncident]) -> Table[RemoteIncident]:
    """A row each, which says on which robot it is, unless none is named."""
    return Table(title="Incidents", columns=tuple(_incident_columns(incidents)), rows=incidents)


def _incident_columns(incidents: Sequence[RemoteIncident]) -> Iterator[Column[RemoteIncident]]:
    if any(one.robot for one in incidents):
        yield Column("Robot", "", lambda one: one.robot, is_text=True)
    yield Column("Incident", "", lambda one: one.name, is_text=True)
    yield Column("Rule", "", lambda one: one.rule, is_text=True)
    yield Column("Moments", "", lambda one: one.moments, WHOLE)
    yield Column("Messages", "", lambda one: one.messages, WHOLE)
    yield Column("Size", "MB", lambda one: one.size_bytes / BYTES_PER_MB)
    yield Column("Read", "", lambda one: "yes" if one.is_read else "no", is_text=True)
    yield Column("Missing", "", lambda one: ", ".join(one.missing), is_text=True)


EXIT_ERROR = 1
_MOMENTS_SHOWN = 20


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Work with incidents, which Record statements keep: each is a folder that 'testudo bag' and "
        "'ros2 bag' read, too."
    )
    actions = parser.add_commands("actions")
    listing = _action(
        actions, "list", "list the incidents of a folder or a robot, oldest first", needs_folder=False
    )
    listing.add_argument("--json", action="store_true", help="print a JSON array instead of a table")
    add_connect(listing)
    add_robot(listing)
    listing.set_defaults(run=_list)
    showing = _action(
        actions, "show", "show what an incident holds, why it was recorded, and what is missing", name=True
    )
    showing.add_argument("--json", action="store_true", help="print its record")
    showing.set_defaults(run=_show)
    fetching = actions.add_parser(
        "fetch",
        help="fetch an incident from a robot over its link",
        description="Fetch an incident in the part of the link that live topics leave unused: first one "
        "message a second of each topic, then ever more, images last. A fetch that was stopped or cut off "
        "goes on.",
    )
    fetching.add_argument("name", metavar="NAME", help="the incident, as 'list --connect' prints it")
    fetching.add_argument(
        "--output", metavar="DIR", type=file_path, required=True, help="the folder it is put into"
    )
    fetching.add_argument("--json", action="store_true", help="print the result as a JSON object")
    add_connect(fetching)
    add_robot(fetching)
    fetching.set_defaults(run=fetch)
    exporting = _action(actions, "export", "copy an incident to another place", name=True)
    exporting.add_argument("--output", metavar="PATH", type=file_path, required=True, help="the new folder")
    exporting.set_defaults(run=_export)
    deleting = _action(actions, "delete", "delete an incident", name=True)
    deleting.set_defaults(run=_delete)


def _action(
    actions: Subcommands,
    word: str,
    meaning: str,
    *,
    name: bool = False,
    needs_folder: bool = True,
) -> argparse.ArgumentParser:
    parser = actions.add_parser(word, help=meaning, description=f"{meaning[0].upper()}{meaning[1:]}.")
    parser.add_argument(
        "folder",
        metavar="DIR",
        type=file_path,
        nargs=None if needs_folder else "?",
        help="the folder that --incidents named",
    )
    if name:
        parser.add_argument("name", metavar="NAME", help="the incident's folder, as 'list' prints it")
    return parser


def _list(arguments: argparse.Namespace) -> int:
    """A line for each incident; one that cannot be read is named, and costs only itself."""
    if arguments.connect and arguments.folder is None:
        return list_remote(arguments)
    if arguments.connect or arguments.folder is None:
        raise UsageError(
            "list the incidents of a folder or of a robot", place="list", remedy="name DIR or --connect"
        )
    connect_options(arguments)
    found: list[StoredIncident] = []
    errors: list[RecordingError] = []
    for one in IncidentStore(arguments.folder).incidents():
        if isinstance(one, RecordingError):
            errors.append(one)
        else:
            found.append(one)
    if arguments.json:
        write_line(json_text([_json(one) for one in found]))
    elif found:
        print_table(incident_table([one.listed() for one in found]))
    else:
        write_line("no incidents")
    for error in errors:
        write_line(str(error), sys.stderr)
    return EXIT_ERROR if errors else 0


def _show(arguments: argparse.Namespace) -> int:
    store = IncidentStore(arguments.folder)
    stored = store.incident(arguments.name)
    store.mark_read(arguments.name)
    if arguments.json:
        write_line(json_text(_json(stored)))
        _tell_differences(stored)
        return 0
    record = stored.record
    before_s = (record.triggered_ns - record.from_ns) / NS_PER_S
    after_s = (record.to_ns - record.triggered_ns) / NS_PER_S
    window = f"{before_s:g} s before to {after_s:g} s after"
    write_line(f"{record.name}: {utc_time(record.triggered_ns)}, {window}")
    write_line(f"rule {record.rule} ({record.path}:{record.line}), rules {record.rules_sha256[:12]}")
    write_lines(chain(signal_texts(record.values), _moment_texts(record)))
    print_table(_topic_table(stored))
    for missing in record.missing:
        write_line(f"missing: {missing_text(missing)}")
    for latched in record.latched:
        write_line(f"latched: {latched.topic} of {utc_time(latched.stamp_ns)}")
    _tell_differences(stored)
    return 0


def _moment_texts(record: IncidentRecord) -> Iterator[str]:
    """Further moments at which the rule began to hold, with what its condition read; of many, the first."""
    shown = record.further_moments[:_MOMENTS_SHOWN]
    for moment in shown:
        later_s = (moment.triggered_ns - record.triggered_ns) / NS_PER_S
        yield ", ".join((f"again after {later_s:g} s", *signal_texts(moment.values)))
    if more := record.moments - 1 - len(shown):
        yield f"and {counted(more, 'time')} more ('--json' shows {len(record.further_moments)} in all)"


def _tell_differences(stored: StoredIncident) -> None:
    """Say where the recording is not what its record says: it may have been cut or altered since."""
    try:
        from smarttestudo.bags.incident_content import content_notices  # noqa: PLC0415  a robot lacks its packages

        print_notices(content_notices(stored.path, stored.record))
    except ModuleNotFoundError as error:
        missing = missing_package(error, "reading it")
        if missing is None:
            raise
        print_notice(f"the recording was not compared with its record: {missing.cause}")


def _export(arguments: argparse.Namespace) -> int:
    store = IncidentStore(arguments.folder)
    files = store.export(arguments.name, arguments.output)
    store.mark_read(arguments.name)
    write_line(f"{counted(files, 'file')} in {arguments.output}")
    _tell_differences(store.incident(arguments.name))
    return 0


def _delete(arguments: argparse.Namespace) -> int:
    IncidentStore(arguments.folder).delete(arguments.name)
    write_line(f"deleted {arguments.name}")
    return 0


def _json(stored: StoredIncident) -> dict[str, object]:
    listed = stored.listed()
    return {
        "incident": stored.name,
        "label": listed.label,
        "messages": listed.messages,
        "size_bytes": stored.size_bytes,
        "read": stored.is_read,
        "moments": listed.moments,
        **incident_to_json(stored.record),
    }


def _topic_table(stored: StoredIncident) -> Table[tuple[str, IncidentTopic]]:
    return Table(
        title="Topics",
        columns=(
            Column("Topic", "", lambda row: row[0], is_text=True),
            Column("Type", "", lambda row: row[1].type_name, is_text=True),
            Column("Messages", "", lambda row: row[1].messages, WHOLE),
            Column("Size", "KB", lambda row: row[1].size_bytes / BYTES_PER_KB, decimals(1)),
        ),
        rows=[*stored.record.topics.items()],
    )
