# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo ruler``: the web page on which rules are built."""

from __future__ import annotations

import argparse
import sys
import threading
import webbrowser
from functools import partial
from pathlib import Path

from smarttestudo.cli.arguments import LAST_PORT, file_path, whole_number_type
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.link_options import add_connect, connect_options, warn
from smarttestudo.cli.output import write_line
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.link.zenoh import open_link_incidents, open_link_robots
from smarttestudo.robot.ros import open_graph_robots
from smarttestudo.ruler.files.project_folder import ProjectFolder

DEFAULT_PORT = 8750


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Serve a page on which rules are built, checked, optimized and tried. It reads and "
        "writes the files of one folder: that of FILE, or FOLDER. Ctrl-C ends it."
    )
    parser.add_argument(
        "path", metavar="FILE|FOLDER", nargs="?", type=file_path, default=Path(), help="default: this folder"
    )
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        help="the address to listen on; other machines need a token that is printed, one to change things or "
        "one to watch only (default: %(default)s)",
    )
    parser.add_argument(
        "--port",
        type=whole_number_type(0, LAST_PORT, refusal=f"a port is a number from 0 to {LAST_PORT}, not {{}}"),
        default=DEFAULT_PORT,
        help="0 takes a free one (default: %(default)s)",
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open the page in a browser")
    parser.add_argument(
        "--watch-only", action="store_true", help="let nobody change files or robots on the page"
    )
    add_connect(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl-C."""
    from smarttestudo.ruler.incidents.robot_incidents import OpenIncidents  # noqa: PLC0415
    from smarttestudo.ruler.robots.link import OpenRobots  # noqa: PLC0415
    from smarttestudo.ruler.server.guard import ServerAddress  # noqa: PLC0415  needs packages a robot lacks
    from smarttestudo.ruler.server.page import is_page_built  # noqa: PLC0415
    from smarttestudo.ruler.server.server import serve  # noqa: PLC0415

    path: Path = arguments.path
    options = connect_options(arguments)
    if not path.is_dir() and path.parent.is_dir() is False:
        raise RuleFileError("there is no such folder", place=str(path.parent), remedy="check the path")
    folder = path if path.is_dir() else path.parent

    open_robots: OpenRobots = partial(open_graph_robots, "testudo_ruler")
    open_incidents: OpenIncidents | None = None
    if options is not None:
        open_robots = partial(open_link_robots, options, warn)
        open_incidents = partial(open_link_incidents, options, warn)

    def started(access: ServerAddress) -> None:
        write_line(f"ADIRF Ruler of {folder.resolve()}: {access.url} (Ctrl-C ends it)")
        if access.watch_url is not None:
            write_line(f"to watch only: {access.watch_url}")
        if not is_page_built():
            write_line("note: the page is not built; it says how to build it")
        # Whoever starts it in a pipe waits for the address.
        sys.stdout.flush()
        if is_page_built() and not arguments.no_browser:
            # A browser may take its time, or wait for the server.
            threading.Thread(target=webbrowser.open, args=(access.url,), daemon=True).start()

    serve(
        ProjectFolder(folder, opened=None if path.is_dir() else path.name),
        open_robots,
        open_incidents=open_incidents,
        host=arguments.host,
        port=arguments.port,
        is_watch_only=arguments.watch_only,
        started=started,
    )
    return 0
