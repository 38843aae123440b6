# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The process of one job: it reads a request from standard input, and writes messages, a line of JSON each.

Its arguments are the module and the name of the job, and the folder of the project. It imports nothing of
the other jobs.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.job import Job, Report, answer_json
from smarttestudo.ruler.problem import Problem, problem_of

_MIN_STEP = 0.01


class Share(Struct, frozen=True, kw_only=True, tag_field="kind", tag="progress"):
    """How far it is, 0 … 1."""

    share: float


class Done(Struct, frozen=True, kw_only=True, tag_field="kind", tag="result"):
    """The answer."""

    result: msgspec.Raw


class Failed(Struct, frozen=True, kw_only=True, tag_field="kind", tag="error"):
    """Why there is no answer."""

    status: int
    problem: Problem


Said = Share | Done | Failed


class FailedError(TestudoError):
    """The failure of a job in its process, in the words of the page."""

    def __init__(self, failed: Failed) -> None:
        problem = failed.problem
        super().__init__(problem.message, place=problem.place or None, remedy=problem.remedy or None)
        self.status, self.findings = failed.status, problem.findings


def command(job: Job[..., Any], root: Path) -> tuple[str, ...]:
    """The arguments of Python for a process that does ``job``."""
    return "-m", __name__, job.do.__module__, job.do.__name__, str(root)


def _main(module: str, name: str, root: str) -> int:
    job: Job[..., Any] = getattr(import_module(module), name)
    project = ProjectFolder(Path(root))
    asked = msgspec.json.decode(sys.stdin.buffer.read(), type=job.asked)
    given = {job.asked: asked, ProjectFolder: project, Report: _Reporter()}
    try:
        answer = job(**{parameter: given[kind] for parameter, kind in job.needs.items()})
    except TestudoError as error:
        status, problem = problem_of(error, project.shown)
        _say(Failed(status=status, problem=problem))
        return 1
    _say(Done(result=msgspec.Raw(answer_json(answer))))
    return 0


class _Reporter:
    """Says how far it is, a hundred times at most."""

    def __init__(self) -> None:
        self._said = 0.0

    def __call__(self, share: float) -> None:
        if share >= self._said + _MIN_STEP:
            self._said = share
            _say(Share(share=round(min(share, 1.0), 3)))


def _say(message: Said) -> None:
    sys.stdout.buffer.write(msgspec.json.encode(message) + b"\n")
    sys.stdout.buffer.flush()


if __name__ == "__main__":
    sys.exit(_main(*sys.argv[1:]))
