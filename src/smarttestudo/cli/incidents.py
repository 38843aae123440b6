# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo incidents``."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from smarttestudo.bags.incident_mark import missing_text, signal_texts
from smarttestudo.cli.bag_options import print_notice, print_notices
from smarttestudo.cli.command_parser import CommandParser
from smarttestudo.cli.link_options import add_connect, connect_options
from smarttestudo.cli.output import write_line
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.remote_incidents import fetch, incident_table, list_remote
from smarttestudo.cli.robots import add_robot
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.errors import RecordingError, UsageError, missing_package
from smarttestudo.domain.incident import IncidentTopic, incident_to_json
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S, counted, utc_time
from smarttestudo.incidents.store import IncidentStore, StoredIncident
from smarttestudo.report.table import WHOLE, Column, Table, decimals

if TYPE_CHECKING:
    from smarttestudo.cli.command_parser import Subcommands

EXIT_ERROR = 1


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
    """One line each; those that cannot be read are named, and cost only themselves."""
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
    write_line(
        f"{record.name}: {utc_time(record.triggered_ns)}, {before_s:g} s before to {after_s:g} s after"
    )
    write_line(f"rule {record.rule} ({record.path}:{record.line}), rules {record.rules_sha256[:12]}")
    for text in signal_texts(record):
        write_line(text)
    print_table(_topic_table(stored))
    for missing in record.missing:
        write_line(f"missing: {missing_text(missing)}")
    for latched in record.latched:
        write_line(f"latched: {latched.topic} of {utc_time(latched.stamp_ns)}")
    _tell_differences(stored)
    return 0


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
