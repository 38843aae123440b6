# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Pushed rules written to the rule file of a live run."""

from __future__ import annotations

from pathlib import Path

import pytest

from smarttestudo.domain.errors import TestudoError
from smarttestudo.robot.rule_writing import RuleFileWriter

OLD = "begin SetFrequency /imu 10 end\n"
NEW = "begin SetFrequency /imu 25 end\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "rules.adirf"
    path.write_text(OLD, encoding="utf-8")
    return path


def previous(path: Path) -> Path:
    return path.with_name("rules.adirf.previous")


def test_the_file_holds_the_new_rules_and_the_old_ones_are_beside_it(path: Path) -> None:
    path.chmod(0o640)
    writer = RuleFileWriter([path], is_allowed=True)
    assert writer.file == str(path)
    said = writer.write(NEW, {str(path): OLD})
    assert said == f"pushed rules written to {path}; what it held is in rules.adirf.previous"
    assert (path.read_text(), previous(path).read_text()) == (NEW, OLD)
    assert path.stat().st_mode & 0o777 == 0o640
    # The next write keeps the version before it, and a folder with the file reads only that.
    RuleFileWriter([path.parent], is_allowed=True).write(OLD, {str(path): NEW})
    assert (path.read_text(), previous(path).read_text()) == (OLD, NEW)


def test_without_consent_nothing_is_written(path: Path) -> None:
    writer = RuleFileWriter([path], is_allowed=False)
    assert not writer.file
    with pytest.raises(TestudoError, match="--allow-writing-rules"):
        writer.write(NEW, {str(path): OLD})
    assert [one.name for one in path.parent.iterdir()] == ["rules.adirf"]


@pytest.mark.parametrize("loaded", [{}, {"rules.adirf": OLD}, {"here": NEW}])
def test_a_file_that_changed_since_it_was_loaded_stays(path: Path, loaded: dict[str, str]) -> None:
    known = {str(path) if name == "here" else name: text for name, text in loaded.items()}
    with pytest.raises(TestudoError, match="changed since it was loaded"):
        RuleFileWriter([path], is_allowed=True).write(NEW, known)
    assert path.read_text() == OLD
    assert not previous(path).exists()


def test_a_file_that_went_away_is_not_made_anew(path: Path) -> None:
    path.unlink()
    with pytest.raises(TestudoError, match="changed since it was loaded"):
        RuleFileWriter([path], is_allowed=True).write(NEW, {str(path): OLD})


def test_a_file_that_was_never_there_is_made(tmp_path: Path) -> None:
    path = tmp_path / "rules.adirf"
    writer = RuleFileWriter([path], is_allowed=True)
    assert writer.file == str(path)
    assert writer.write(NEW, {}) == f"pushed rules written to {path}"
    assert path.read_text() == NEW


def test_one_text_does_not_go_into_several_files(path: Path) -> None:
    other = path.with_name("other.adirf")
    other.write_text(OLD, encoding="utf-8")
    for rules in ([path, other], [path.parent]):
        writer = RuleFileWriter(rules, is_allowed=True)
        assert not writer.file
        with pytest.raises(TestudoError, match="one text, and the runtime has 2 rule files"):
            writer.write(NEW, {str(path): OLD, str(other): OLD})
    with pytest.raises(TestudoError, match="no rule files"):
        RuleFileWriter([], is_allowed=True).write(NEW, {})


def test_a_file_that_cannot_be_written_stays_as_it_was(path: Path) -> None:
    previous(path).mkdir()
    with pytest.raises(TestudoError, match="cannot be written"):
        RuleFileWriter([path], is_allowed=True).write(NEW, {str(path): OLD})
    assert path.read_text() == OLD
