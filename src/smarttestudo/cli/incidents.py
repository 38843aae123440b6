# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo incidents``."""

from __future__ import annotations

import argparse
import sys

from smarttestudo.adapters.files.incident_store import IncidentStore, StoredIncident
from smarttestudo.adapters.json.incidents import incident_to_json
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import Missing
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB, NS_PER_S, counted, utc_time
from smarttestudo.visualizer.table import Align, Column, Number, Row, Table, Text

EXIT_ERROR = 1


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``incidents`` to the subcommands."""
    parser = commands.add_parser(
        "incidents",
        help="list, show, export and delete what rules recorded",
        description="What Record statements kept: a folder for each incident, that 'testudo bag' and "
        "'ros2 bag' read, too.",
    )
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    listing = _action(actions, "list", "all incidents of a folder, oldest first")
    listing.add_argument("--json", action="store_true", help="print a JSON array instead of a table")
    listing.set_defaults(run=_list)
    showing = _action(actions, "show", "what one holds, why, and what is missing", name=True)
    showing.add_argument("--json", action="store_true", help="print its record")
    showing.set_defaults(run=_show)
    exporting = _action(actions, "export", "copy one to another place", name=True)
    exporting.add_argument("--output", metavar="PATH", type=file_path, required=True, help="the new folder")
    exporting.set_defaults(run=_export)
    deleting = _action(actions, "delete", "delete one", name=True)
    deleting.set_defaults(run=_delete)


def _action(
    actions: argparse._SubParsersAction[argparse.ArgumentParser],
    word: str,
    meaning: str,
    *,
    name: bool = False,
) -> argparse.ArgumentParser:
    parser = actions.add_parser(word, help=meaning, description=f"{meaning[0].upper()}{meaning[1:]}.")
    parser.add_argument("folder", metavar="DIR", type=file_path, help="what --incidents named")
    if name:
        parser.add_argument("name", metavar="NAME", help="the incident's folder, as 'list' prints it")
    return parser


def _list(arguments: argparse.Namespace) -> int:
    """One line each; those that cannot be read are named, and cost only themselves."""
    found: list[StoredIncident] = []
    errors: list[RecordingError] = []
    for one in IncidentStore(arguments.folder).incidents():
        if isinstance(one, RecordingError):
            errors.append(one)
        else:
            found.append(one)
    if arguments.json:
        print(json_text([_json(one) for one in found]))  # noqa: T201
    elif found:
        print_table(_list_table(found))
    else:
        print("no incidents")  # noqa: T201
    for error in errors:
        print(error, file=sys.stderr)  # noqa: T201
    return EXIT_ERROR if errors else 0


def _show(arguments: argparse.Namespace) -> int:
    store = IncidentStore(arguments.folder)
    stored = store.incident(arguments.name)
    store.mark_read(arguments.name)
    if arguments.json:
        print(json_text(_json(stored)))  # noqa: T201
        return 0
    record = stored.record
    before_s = (record.triggered_ns - record.from_ns) / NS_PER_S
    after_s = (record.to_ns - record.triggered_ns) / NS_PER_S
    print(f"{record.name}: {utc_time(record.triggered_ns)}, {before_s:g} s before to {after_s:g} s after")  # noqa: T201
    print(f"rule {record.rule} ({record.path}:{record.line}), rules {record.rules_sha256[:12]}")  # noqa: T201
    for signal, value in record.values.items():
        print(f"{signal} = {'unknown' if value is None else format(value, 'g')}")  # noqa: T201
    print_table(_topic_table(stored))
    for missing in record.missing:
        print(f"missing: {_said(missing)}")  # noqa: T201
    for latched in record.latched:
        print(f"latched: {latched.topic} of {utc_time(latched.stamp_ns)}")  # noqa: T201
    return 0


def _export(arguments: argparse.Namespace) -> int:
    store = IncidentStore(arguments.folder)
    files = store.export(arguments.name, arguments.output)
    store.mark_read(arguments.name)
    print(f"{counted(files, 'file')} in {arguments.output}")  # noqa: T201
    return 0


def _delete(arguments: argparse.Namespace) -> int:
    IncidentStore(arguments.folder).delete(arguments.name)
    print(f"deleted {arguments.name}")  # noqa: T201
    return 0


def _json(stored: StoredIncident) -> dict[str, object]:
    return {
        "incident": stored.name,
        "size_bytes": stored.size_bytes,
        "read": stored.is_read,
        **incident_to_json(stored.record),
    }


def _list_table(incidents: list[StoredIncident]) -> Table:
    return Table(
        title="Incidents",
        columns=(
            Column(heading="Incident", align=Align.LEFT),
            Column(heading="Rule", align=Align.LEFT),
            Column(heading="Messages"),
            Column(heading="Size", unit="MB"),
            Column(heading="Read", align=Align.LEFT),
            Column(heading="Missing", align=Align.LEFT),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(one.name),
                    Text(one.record.rule),
                    Number(sum(topic.messages for topic in one.record.topics.values()), decimals=0),
                    Number(one.size_bytes / BYTES_PER_MB),
                    Text("yes" if one.is_read else "no"),
                    Text(", ".join(dict.fromkeys(each.reason.value for each in one.record.missing))),
                )
            )
            for one in incidents
        ),
    )


def _topic_table(stored: StoredIncident) -> Table:
    return Table(
        title="Topics",
        columns=(
            Column(heading="Topic", align=Align.LEFT),
            Column(heading="Type", align=Align.LEFT),
            Column(heading="Messages"),
            Column(heading="Size", unit="KB"),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(name),
                    Text(topic.type_name),
                    Number(topic.messages, decimals=0),
                    Number(topic.size_bytes / BYTES_PER_KB, decimals=1),
                )
            )
            for name, topic in stored.record.topics.items()
        ),
    )


def _said(missing: Missing) -> str:
    messages = "what came" if missing.messages is None else counted(missing.messages, "message")
    between = f"{utc_time(missing.from_ns)} to {utc_time(missing.to_ns)}"
    return f"{missing.topic}: {messages} from {between} ({missing.reason.value})"
