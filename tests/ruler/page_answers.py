# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the server answers the page's tests in gui/tests/page: asked of a real server, and kept in files."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from ruler.page_projects import MadeProjects
from ruler.ruler_server import Answer, Page, served
from smarttestudo import __version__
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.remote_robots import RemoteRobots
from smarttestudo.ruler.job import all_jobs

PAGE_TESTS = Path(__file__).parents[2] / "gui" / "tests" / "page"
ANSWERS = PAGE_TESTS / "answers"
START_S = 1_700_000_000
"""When a project was written, in seconds since 1970; each change comes a minute after the last."""
MINUTE_S = 60
PURE = frozenset(
    f"POST /api/{path}"
    for path in (
        "difference",
        "document",
        "edit",
        "export",
        "format",
        "import",
        "import/preview",
        "optimize",
        "profile/check",
        "profile/entry",
        "profile/levels",
        "profile/parse",
        "profile/write",
        "vocabulary",
        "zones",
        "zones/cover",
    )
)
"""What is answered from what is sent alone, whatever is in the project."""
READING = {job.route for job in all_jobs() if job.reads}


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A request with its answer; or, without an answer, texts that somebody else writes into files.

    ``body`` is what was sent, as JSON or ``{"base64": …}``; ``None`` as text removes a file.
    """

    ask: str = ""
    body: Any = None
    answer: Any = None
    files: Mapping[str, str | None] | None = None

    @property
    def changes(self) -> bool:
        """Whether the server answers otherwise afterwards."""
        method, path = self.ask.split(" ", 1) if self.ask else ("", "")
        return self.files is not None or f"{method} {urlsplit(path).path}" not in READING


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedTest:
    """A test's project, the files that it adds to it, and its steps."""

    project: str
    files: Mapping[str, str | None] = field(default_factory=dict)
    steps: Sequence[Step] = ()


@dataclass(slots=True)
class ProjectServer:
    """A real server of a project whose files and clock are the same each time."""

    page: Page
    folder: Path
    changes: int = 0

    def ask(self, ask: str, body: Any) -> Any:
        """What the server answers, with nothing in it that differs from run to run."""
        method, path = ask.split(" ", 1)
        answer = self.page.request(method, path, *_sent(body))
        if Step(ask=ask).changes:
            self.pass_minute()
        return _steady(answer, self.folder)

    def write(self, files: Mapping[str, str | None]) -> None:
        """Write or remove files, as somebody else does."""
        for name, text in files.items():
            path = self.folder / name
            if text is None:
                path.unlink()
            else:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
        self.pass_minute()

    def now_s(self) -> float:
        """The time of this server."""
        return START_S + MINUTE_S * self.changes

    def pass_minute(self) -> None:
        """Note the time at files that were written just now."""
        for path in (self.folder, *self.folder.rglob("*")):
            if path.stat().st_mtime > self.now_s():
                os.utime(path, (self.now_s(), self.now_s()))
        self.changes += 1


@contextmanager
def project_server(made: MadeProjects, folder: Path, test: RecordedTest) -> Iterator[ProjectServer]:
    """The server of the test's project, which is made in ``folder``."""
    shutil.rmtree(folder, ignore_errors=True)
    made.copy(test.project, folder)
    with served(folder, open_robots=_no_robots) as page:
        server = ProjectServer(page, folder)
        server.write(test.files)
        yield server


def _no_robots() -> AbstractContextManager[RemoteRobots]:
    raise RosError("these tests have no robot")


def _sent(body: Any) -> tuple[bytes | None, Mapping[str, str | None]]:
    if isinstance(body, dict) and body.keys() == {"base64"}:
        return base64.b64decode(body["base64"]), {"Content-Type": "application/octet-stream"}
    return None if body is None else json.dumps(body).encode(), {}


def _steady(answer: Answer, folder: Path) -> Any:
    kind = answer.headers.get("content-type", "")
    if not kind.startswith("application/json"):
        return {"status": answer.status, "type": kind, "base64": base64.b64encode(answer.body).decode()}
    text = answer.body.decode().replace(str(folder.resolve()), "/project")
    return {"status": answer.status, "json": json.loads(text, object_hook=_steady_object)}


def _steady_object(value: dict[str, Any]) -> dict[str, Any]:
    if "root_hash" in value:
        return {**value, "root_name": "project", "root_hash": "project", "version": "1.0.0", "ros": True}
    return {name: "1.0.0" if each == __version__ else each for name, each in value.items()}


def in_order(steps: Sequence[Step]) -> list[Step]:
    """Sort requests between two changes, and leave out those whose answer is known from before.

    When a page asks about what it has depends on the machine: such requests come first.
    """
    known: dict[str, str] = {}
    ordered = _new_of([step for step in steps if step.ask in PURE], known)
    stage: list[Step] = []
    for step in steps:
        if step.changes:
            ordered += [*_new_of(stage, known), step]
            stage = []
        elif step.ask not in PURE:
            stage.append(step)
    return ordered + _new_of(stage, known)


def _new_of(stage: Sequence[Step], known: dict[str, str]) -> list[Step]:
    found = []
    for step in sorted(stage, key=_request):
        answer = json.dumps(step.answer)
        if known.get(_request(step)) != answer:
            found.append(step)
        known[_request(step)] = answer
    return found


def _request(step: Step) -> str:
    return f"{step.ask} {json.dumps(step.body)}"


def written(tests: Mapping[str, RecordedTest]) -> str:
    """A file of answers: each body and each answer in it once, named by its hash, in a line."""
    bodies: dict[str, Any] = {}
    answers: dict[str, Any] = {}
    entries = {}
    for name, test in sorted(tests.items()):
        steps = [_entry(step, bodies, answers) for step in test.steps]
        entries[name] = {"project": test.project, "files": dict(test.files), "steps": steps}
    sections = (("tests", entries), ("bodies", bodies), ("answers", answers))
    return "{\n" + ",\n".join(_section(*each) for each in sections) + "\n}\n"


def _entry(step: Step, bodies: dict[str, Any], answers: dict[str, Any]) -> dict[str, Any]:
    if step.files is not None:
        return {"files": dict(step.files), "changes": True}
    entry: dict[str, Any] = {"ask": step.ask}
    if step.body is not None:
        entry["body"] = _kept(step.body, bodies)
    entry["answer"] = _kept(step.answer, answers)
    return {**entry, "changes": True} if step.changes else entry


def _kept(value: Any, values: dict[str, Any]) -> str:
    name = hashlib.sha256(json.dumps(value).encode()).hexdigest()[:12]
    values[name] = value
    return name


def _section(name: str, values: Mapping[str, Any]) -> str:
    lines = (f"  {_text(key)}: {_text(value)}" for key, value in sorted(values.items()))
    return f' "{name}": {{\n' + ",\n".join(lines) + "\n }"


def _text(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def read(path: Path) -> dict[str, RecordedTest]:
    """The tests of a file that ``written`` wrote."""
    file = json.loads(path.read_text(encoding="utf-8"))
    tests = {}
    for name, entry in file["tests"].items():
        steps = [
            Step(files=one["files"])
            if "files" in one
            else Step(
                ask=one["ask"],
                body=file["bodies"].get(one.get("body")),
                answer=file["answers"][one["answer"]],
            )
            for one in entry["steps"]
        ]
        tests[name] = RecordedTest(project=entry["project"], files=entry["files"], steps=steps)
    return tests
