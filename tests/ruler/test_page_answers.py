# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page's tests in gui/tests/page play what the server answers today."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from ruler.page_answers import ANSWERS, PAGE_TESTS, RecordedTest, Step, project_server, read
from ruler.page_projects import MadeProjects

TITLE = re.compile(r'\btest(?:\.\w+\((?:[^()]|\([^()]*\))*\))?\(\s*(?:"([^"]+)"|`([^`]+)`)')
PLACE = re.compile(r"%[sdifjop]|\\?\$\\?\{[^}]*\\?\}|\\?\$\w+")
"""Where ``test.each`` puts a value of the case."""


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> MadeProjects:
    return MadeProjects(tmp_path_factory.mktemp("made"))


@pytest.mark.parametrize("path", sorted(ANSWERS.glob("*.json")), ids=lambda path: path.stem)
def test_the_server_answers_as_recorded(path: Path, made: MadeProjects, tmp_path: Path) -> None:
    looking: dict[str, dict[str, RecordedTest]] = {}
    for name, test in read(path).items():
        if any(step.changes for step in test.steps):
            changed = _first_changed([test], made, tmp_path)
            assert changed is None, _remedy(path, name, changed)
        else:
            looking.setdefault(f"{test.project} {dict(test.files)}", {})[name] = test
    # Those that change nothing share a server.
    for tests in looking.values():
        changed = _first_changed(list(tests.values()), made, tmp_path)
        assert changed is None, _remedy(path, ", ".join(tests), changed)


@pytest.mark.parametrize("path", sorted(ANSWERS.glob("*.json")), ids=lambda path: path.stem)
def test_no_answers_are_kept_of_a_test_that_is_gone(path: Path) -> None:
    source = (PAGE_TESTS / f"{path.stem}.test.tsx").read_text(encoding="utf-8")
    titles = [PLACE.sub(".*", re.escape(plain or each)) for plain, each in TITLE.findall(source)]
    gone = [name for name in read(path) if not any(re.fullmatch(title, name) for title in titles)]
    assert gone == [], f"{path.name} has answers of tests that are gone: make page-answers TESTS={path.stem}"


def _first_changed(tests: Sequence[RecordedTest], made: MadeProjects, folder: Path) -> str | None:
    same: list[Step] = []
    with project_server(made, folder / "project", tests[0]) as server:
        for step in (step for test in tests for step in test.steps):
            if step.files is not None:
                server.write(step.files)
            elif step.changes or step not in same:
                if server.ask(step.ask, step.body) != step.answer:
                    return step.ask if step.body is None else f"{step.ask} {str(step.body)[:200]}"
                same.append(step)
    return None


def _remedy(path: Path, test: str, changed: str | None) -> str:
    return f"{path.stem}, {test}: {changed} is answered otherwise: make page-answers TESTS={path.stem}"
