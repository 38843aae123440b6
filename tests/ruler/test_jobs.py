# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The contract of each job of the page, from the table of all of them."""

from __future__ import annotations

import asyncio
import inspect
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ruler.ruler_server import Page, served
from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Job, Report, all_jobs
from smarttestudo.ruler.server.processes import Processes
from smarttestudo.ruler.tries.try_rules import TryRequest, try_on

JOBS = all_jobs()
ASKING = [job for job in JOBS if job.asked is not None]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with served(tmp_path_factory.mktemp("project")) as page:
        yield page


def test_each_route_has_one_job() -> None:
    routes = [job.route for job in JOBS]
    assert len(routes) > 60
    assert len(set(routes)) == len(routes)
    assert {job.method for job in JOBS} == {"GET", "POST", "PUT"}
    assert all(job.path.startswith("/api/") for job in JOBS)


def test_what_takes_long_has_a_name_by_which_the_page_is_told_how_far_it_is() -> None:
    limited = [job for job in JOBS if job.limit is not None]
    assert limited
    for job in limited:
        assert job.asked is not None
        assert "run" in job.asked.__struct_fields__, job.route
        # Its process has nothing else.
        assert set(job.needs.values()) <= {job.asked, ProjectFolder, Report}, job.route


@pytest.mark.parametrize("job", ASKING, ids=lambda job: str(job.route))
def test_a_body_that_is_none_of_the_job_is_refused(page: Page, job: Job[..., Any]) -> None:
    for body in (b"", b"[]", b"{"):
        answer = page.request(job.method, job.path, body)
        assert (answer.status, bool(answer.error)) == (400, True)
    assert page.request(job.method, job.path, b"{}", {"Content-Type": "text/plain"}).status == 415


@pytest.mark.parametrize("job", JOBS, ids=lambda job: str(job.route))
def test_a_job_can_be_given_all_that_it_needs(page: Page, job: Job[..., Any]) -> None:
    parameters = inspect.signature(job.do).parameters
    assert list(job.needs) == list(parameters)
    if job.asked is None and job.method == "GET":
        answer = page.get(job.path)
        assert answer.status < 500, answer.error


@pytest.mark.full
@pytest.mark.parametrize(
    ("program", "status", "words"),
    [
        ("exec sleep 1000", 504, "the recording takes longer than ten minutes"),
        ("exit 1", None, "reading the recording ended without a result"),
        (
            """echo '{"kind": "progress", "share": 0.5}'
            echo '{"kind": "error", "status": 404, "problem":
                {"message": "gone", "place": "", "remedy": "", "findings": []}}' | tr -d '\\n'""",
            404,
            "gone",
        ),
    ],
)
def test_a_process_without_an_answer_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, status: int | None, words: str
) -> None:
    python = tmp_path / "python"
    python.write_text(f"#!/bin/sh\n{program}\n")
    python.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(python))
    told: list[float] = []
    limited = replace(try_on, limit=replace(READING, limit_s=1.0 if status == 504 else 60.0))
    asked = TryRequest(text="", bag="monday")
    with pytest.raises(TestudoError, match=words) as refused, ThreadPoolExecutor(1) as thread:
        # Playwright, if a test before this one used it, keeps a running event loop in this thread.
        thread.submit(asyncio.run, Processes(tmp_path).result(limited, asked, told.append)).result()
    assert getattr(refused.value, "status", None) == status
    assert told == [0.5] * (status == 404)
