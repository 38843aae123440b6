# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A real server on a free port, as the page and as a stranger sees it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

from smarttestudo.robot.ros import open_graph_robots
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.incidents.robot_incidents import OpenIncidents
from smarttestudo.ruler.robots.link import OpenRobots
from smarttestudo.ruler.server.guard import ServerAddress
from smarttestudo.ruler.server.server import listening, ruler_app, server_of

EXAMPLES = Path(__file__).parents[2] / "examples"
TIMEOUT_S = 120


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What the server said."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)

    @property
    def error(self) -> str:
        return str(self.json["error"]["message"])


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """A page that the server on ``port`` served; its browser sends ``origin`` along."""

    port: int

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def get(self, path: str) -> Answer:
        return self.request("GET", path)

    def post(self, path: str, body: object) -> Answer:
        return self.request("POST", path, json.dumps(body).encode())

    def put(self, path: str, body: object) -> Answer:
        return self.request("PUT", path, json.dumps(body).encode())

    def request(
        self, method: str, path: str, body: object = None, headers: Mapping[str, str | None] | None = None
    ) -> Answer:
        """Send what a browser would, changed by ``headers``; ``None`` leaves one out."""
        sent = {"Origin": self.origin, "Content-Type": "application/json", **(headers or {})}
        connection = HTTPConnection("127.0.0.1", self.port, timeout=TIMEOUT_S)
        try:
            chosen = {name: value for name, value in sent.items() if value is not None}
            connection.request(method, path, body, chosen)  # type: ignore[arg-type]
            response = connection.getresponse()
            return Answer(
                status=response.status,
                headers={name.lower(): value for name, value in response.getheaders()},
                body=response.read(),
            )
        finally:
            connection.close()


on_the_graph: OpenRobots = partial(open_graph_robots, "testudo_ruler")


@contextmanager
def served(
    folder: Path,
    port: int = 0,
    *,
    opened: str | None = None,
    token: str | None = None,
    watch_token: str | None = None,
    is_watch_only: bool = False,
    open_robots: OpenRobots = on_the_graph,
    open_incidents: OpenIncidents | None = None,
) -> Iterator[Page]:
    """The server of ``folder`` while the block lasts; with ``token`` as if other machines could reach it.

    Who has ``watch_token`` may only watch, and with ``is_watch_only`` everybody. ``port`` 0 is a free one.
    """
    with listening("127.0.0.1", port) as listener:
        port = listener.getsockname()[1]
        access = ServerAddress.at("127.0.0.1", port, is_watch_only=is_watch_only)
        if token is not None:
            access = ServerAddress(
                host="0.0.0.0",
                port=port,
                names=frozenset({"robot.local"}),
                token=token,
                watch_token=watch_token,
            )
        project = ProjectFolder(folder, opened)
        app = ruler_app(project, access, open_robots, open_incidents=open_incidents)
        server = server_of(app)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield Page(port=port)
        finally:
            server.should_exit = True
            thread.join(TIMEOUT_S)
            assert not thread.is_alive()
