# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records what the server answers the page's tests in gui/tests/page (make page-answers).

Runs these tests in Chromium on a real server, and writes their answers into gui/tests/page/answers. With
names of test files, as ``levels``, only those.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit

from ruler.page_answers import (
    ANSWERS,
    PAGE_TESTS,
    ProjectServer,
    RecordedTest,
    Step,
    in_order,
    project_server,
    written,
)
from ruler.page_projects import MadeProjects

ROOT = Path(__file__).resolve().parent.parent


@dataclass(slots=True)
class Recorder:
    """What the tests ask, one test at a time, of the real server of its project."""

    folder: Path
    recorded: dict[str, dict[str, RecordedTest]] = field(default_factory=dict)
    steps: list[Step] = field(default_factory=list)
    lock: threading.Lock = field(default_factory=threading.Lock)
    stack: ExitStack = field(default_factory=ExitStack)
    server: ProjectServer | None = None

    def begin(self, project: str, files: Mapping[str, str | None]) -> None:
        """Make the project of a test, and serve it."""
        self.stack.close()
        self.steps = []
        made = MadeProjects(self.folder / "made")
        test = RecordedTest(project=project, files=files)
        self.server = self.stack.enter_context(project_server(made, self.folder / "project", test))

    def ask(self, ask: str, body: Any = None) -> Any:
        """Ask the server, and keep what it answered."""
        if not Step(ask=ask).changes:
            return self._kept(ask, body)
        with self.lock:
            self._look_again()
            return self._kept(ask, body)

    def write(self, files: Mapping[str, str | None]) -> None:
        """Write files as somebody else does."""
        with self.lock:
            self._look_again()
            self._server.write(files)
            self.steps.append(Step(files=files))

    def end(self, file: str, test: str, project: str, files: Mapping[str, str | None]) -> None:
        """Keep the steps of a test that ended."""
        self._look_again()
        self.stack.close()
        steps = in_order(self.steps)
        self.recorded.setdefault(file, {})[test] = RecordedTest(project=project, files=files, steps=steps)

    @property
    def _server(self) -> ProjectServer:
        assert self.server is not None
        return self.server

    def _kept(self, ask: str, body: Any) -> Any:
        answer = self._server.ask(ask, body)
        self.steps.append(Step(ask=ask, body=body, answer=answer))
        return answer

    def _look_again(self) -> None:
        """Ask for all that is looked at now and then: when the page does depends on the machine."""
        asked = {step.ask for step in self.steps if step.ask.startswith("GET ")}
        for ask in sorted(asked | {_state(ask) for ask in asked if urlsplit(ask[4:]).path == "/api/file"}):
            self._kept(ask, None)


def _state(ask: str) -> str:
    query = {name: values[0] for name, values in parse_qs(urlsplit(ask[4:]).query).items()}
    return f"GET /api/file/state?{urlencode(query).replace('+', '%20')}"


class _Handler(BaseHTTPRequestHandler):
    def __init__(self, recorder: Recorder, *args: Any) -> None:
        self.recorder = recorder
        super().__init__(*args)

    def do_POST(self) -> None:
        """Do what the path names with what the body says."""
        said = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        acts: Mapping[str, Callable[..., Any]] = {
            "/begin": self.recorder.begin,
            "/ask": self.recorder.ask,
            "/write": self.recorder.write,
            "/end": self.recorder.end,
        }
        answer = json.dumps(acts[self.path](**said)).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(answer)))
        self.end_headers()
        self.wfile.write(answer)

    def log_message(self, *_: Any) -> None:
        """Say nothing of each request."""


@contextmanager
def recording(recorder: Recorder) -> Iterator[str]:
    """The address at which the tests reach the recorder."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, recorder)) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}"
        finally:
            server.shutdown()
            thread.join()


def main(names: list[str]) -> int:
    """Run the tests, and write what was asked; the exit code is that of the tests."""
    with tempfile.TemporaryDirectory() as folder:
        recorder = Recorder(Path(folder))
        with recording(recorder) as url, recorder.stack:
            tests = [f"tests/page/{name}.test.tsx" for name in names]
            command = ["sh", "scripts/gui_npm.sh", "exec", "--", "vitest", "run", "--project", "page", *tests]
            environment = {**os.environ, "PYTHON": sys.executable, "PAGE_RECORDER": url}
            code = subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode
    ANSWERS.mkdir(exist_ok=True)
    for file, recorded in recorder.recorded.items():
        (ANSWERS / f"{file}.json").write_text(written(recorded), encoding="utf-8")
    for path in ANSWERS.glob("*.json"):
        if not (PAGE_TESTS / f"{path.stem}.test.tsx").exists():
            path.unlink()
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
