# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who may only watch is answered, and changes neither a file nor a robot."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from ruler.incident_projects import NEAR_MISS, write_incidents
from ruler.ruler_server import TIMEOUT_S, Page, served
from smarttestudo.ruler.job import all_jobs

RULES = "begin\n    SetFrequency /odom 5\nend\n"
TOKEN, WATCH_TOKEN = "may-change", "may-watch"
REFUSED = "you may only watch here: nothing was changed"
CHANGES = {
    "PUT /api/draft",
    "PUT /api/file",
    "PUT /api/file/tried",
    "POST /api/file/rename",
    "POST /api/file/copy",
    "POST /api/file/delete",
    "PUT /api/recording",
    "POST /api/incident/delete",
    "PUT /api/profile/for",
    "POST /api/profile/measure-live",
    "POST /api/push",
    "POST /api/robot/remove",
    "POST /api/push/confirm",
    "POST /api/push/write",
    "POST /api/try/keep",
    "POST /api/try/keep/cancel",
    "POST /api/robot-incidents/fetch",
    "POST /api/robot-incidents/cancel",
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "a.adirf").write_text(RULES)
    return folder


@pytest.fixture
def page(project: Path) -> Iterator[Page]:
    with served(project, is_watch_only=True) as page:
        yield page


def test_all_that_changes_something_is_refused_and_all_else_is_answered(page: Page) -> None:
    refused = set()
    for job in all_jobs():
        answer = page.request(job.method, job.path, None if job.method == "GET" else b"{}")
        if answer.status == 403 and answer.error == REFUSED:
            refused.add(job.route)
    assert refused == CHANGES


def test_a_file_stays_as_it_was_and_rules_can_be_looked_at(page: Page, project: Path) -> None:
    known = page.get("/api/file?name=a.adirf").json
    assert known["text"] == RULES
    saved = page.put("/api/file", {"name": "a.adirf", "text": "begin end", "base_hash": known["hash"]})
    assert saved.status == 403
    assert saved.json["error"]["remedy"].startswith("ask whoever started testudo ruler")
    assert (project / "a.adirf").read_text() == RULES
    assert page.post("/api/document", {"text": RULES, "name": "a.adirf", "profile_text": None}).status == 200


def test_an_incident_that_only_watchers_saw_stays_unread(tmp_path: Path) -> None:
    project = tmp_path / "project"
    write_incidents(project)
    for is_watch_only in (True, False):
        with served(project, is_watch_only=is_watch_only) as page:
            assert page.post("/api/incident", {"name": NEAR_MISS}).status == 200
            listed = {one["name"]: one for one in page.get("/api/incidents").json["incidents"]}
            assert listed[NEAR_MISS]["incident"]["is_read"] is not is_watch_only


@pytest.mark.parametrize(("token", "status"), [(TOKEN, 400), (WATCH_TOKEN, 403), ("guessed", 401)])
def test_the_token_says_what_somebody_may_do(project: Path, token: str, status: int) -> None:
    with served(project, token=TOKEN, watch_token=WATCH_TOKEN) as page:
        host = {"Host": f"robot.local:{page.port}", "Origin": f"http://robot.local:{page.port}"}
        opened = page.request("GET", f"/?token={token}", headers={**host, "Origin": None})
        cookie = opened.headers.get("set-cookie", "").split(";")[0]
        asked = page.request("POST", "/api/file/delete", b"{}", {**host, "Cookie": cookie})
        looked = page.request("GET", "/api/project", headers={**host, "Cookie": cookie})
    assert asked.status == status
    assert looked.status == (401 if status == 401 else 200)
    assert (project / "a.adirf").exists()


@pytest.mark.full
def test_the_command_prints_a_second_address_for_who_may_only_watch(project: Path) -> None:
    command = [sys.executable, "-m", "smarttestudo", "ruler", str(project), "--port=0", "--no-browser"]
    with subprocess.Popen([*command, "--host=0.0.0.0"], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        first, second = process.stdout.readline(), process.stdout.readline()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=TIMEOUT_S)
    [token] = re.findall(r"token=(\S+)", first)
    matched = re.fullmatch(r"to watch only: http://\S+:\d+/\?token=(\S+)\n", second)
    assert matched is not None
    assert matched[1] != token
