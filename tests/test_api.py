# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What scripts may call. What it gives is shown, and run, in docs/api.md."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import smarttestudo
from bags.bag_factory import small_mission, write_bag
from smarttestudo.domain.errors import (
    Extra,
    ProfileError,
    RuleFileError,
    TestudoError,
    UsageError,
    how_to_install,
)

SIGNATURES = {
    "check_rules": "(*rules, profile=None)",
    "measure_bag": "(bag, *, latency=False)",
    "measure_loss": "(sent, received, *, rules=None, profile=None, topics=())",
    "read_decisions": "(path)",
    "read_rules": "(*rules, profile=None)",
    "replay": (
        "(bag, rules, output, *, profile=None, budget_kb_per_s=None, repeat_slow=False, decisions=None)"
    ),
    "rows": "(result)",
}
RULES = "begin\n    SetFrequency /odom 10\nend\n"


def run(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=False)


def without_types(signature: inspect.Signature) -> str:
    parameters = [one.replace(annotation=one.empty) for one in signature.parameters.values()]
    return str(signature.replace(parameters=parameters, return_annotation=signature.empty))


def rule_file(folder: Path, text: str) -> Path:
    path = folder / "rules.adirf"
    path.write_text(text, encoding="utf-8")
    return path


def test_what_scripts_call_stays_as_it_is() -> None:
    assert sorted(smarttestudo.__all__) == ["__version__", *SIGNATURES]
    functions = {name: getattr(smarttestudo, name) for name in SIGNATURES}
    found = {name: without_types(inspect.signature(function)) for name, function in functions.items()}
    assert found == SIGNATURES
    assert all(inspect.getdoc(function) for function in functions.values())
    assert set(smarttestudo.__all__) <= set(dir(smarttestudo))


def test_importing_the_package_alone_imports_nothing_else() -> None:
    code = """
import sys
before = set(sys.modules)
import smarttestudo
from smarttestudo.domain.errors import Extra, how_to_install
new = {name.partition(".")[0] for name in set(sys.modules) - before} - sys.stdlib_module_names
assert new == {"smarttestudo"}, new
assert "smarttestudo.api" not in sys.modules
"""
    assert run(code).stderr == ""


def test_a_missing_package_is_told_with_its_remedy() -> None:
    code = """
import sys
sys.modules["rosbags"] = None
try:
    from smarttestudo import replay
except Exception as error:
    print(type(error).__name__, error)
"""
    assert run(code).stdout == (
        "MissingPackageError error: smarttestudo.replay needs the package rosbags; "
        f"{how_to_install(Extra.STUDIO)}\n"
    )


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'smarttestudo' has no attribute 'reply'"):
        smarttestudo.reply  # noqa: B018  what is tested


def test_an_error_in_rules_is_a_finding_and_stops_them_from_being_read(tmp_path: Path) -> None:
    path = rule_file(tmp_path, "SetDefaultFrequency /odom fast\n")
    (row,) = smarttestudo.rows(smarttestudo.check_rules(path))
    assert (row["path"], row["line"], row["severity"]) == (str(path), 1, "error")
    with pytest.raises(RuleFileError, match=re.escape(str(row["message"]))):
        smarttestudo.read_rules(path)


def test_rules_without_an_error_are_checked_against_the_budget_too(tmp_path: Path) -> None:
    path, profile = rule_file(tmp_path, RULES), tmp_path / "profile.toml"
    profile.write_text('budget_kb_per_s = 5\n[topics."/odom"]\nmessage_kb = 1.0\n', encoding="utf-8")
    assert smarttestudo.check_rules(path) == ()
    found = [finding.code for finding in smarttestudo.check_rules(path, profile=profile)]
    assert found == ["situation-over-budget", "start-up-over-budget"]
    with pytest.raises(ProfileError, match="cannot be read"):
        smarttestudo.check_rules(path, profile=tmp_path / "none.toml")


def test_a_replay_does_not_write_over_what_it_reads(tmp_path: Path) -> None:
    rules = smarttestudo.read_rules(rule_file(tmp_path, RULES))
    bag = tmp_path / "bag"
    with pytest.raises(UsageError, match=r"^output: error: .* is read by this command"):
        smarttestudo.replay(bag, rules, bag)


def test_a_path_in_place_of_rules_and_a_budget_below_zero_are_refused(tmp_path: Path) -> None:
    path, output = rule_file(tmp_path, RULES), tmp_path / "output"
    rules = smarttestudo.read_rules(path)
    needed = "rules: error: rules that were read are needed, not '.*; give what read_rules returns"
    with pytest.raises(UsageError, match=needed):
        smarttestudo.replay(tmp_path, str(path), output)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=needed):
        smarttestudo.measure_loss(tmp_path, tmp_path, rules=str(path))  # type: ignore[arg-type]
    for budget in (-3.0, float("nan")):
        with pytest.raises(UsageError, match="budget_kb_per_s: error: a budget is a number of KB/s from 0"):
            smarttestudo.replay(tmp_path, rules, output, budget_kb_per_s=budget)


def test_decisions_take_the_place_of_decisions_and_of_no_other_file(tmp_path: Path) -> None:
    bag, path = write_bag(tmp_path / "bag", small_mission(1)), rule_file(tmp_path, RULES)
    rules, log = smarttestudo.read_rules(path), tmp_path / "decisions.jsonl"
    with pytest.raises(TestudoError, match=r"rules.adirf: error: .* holds something else; name another"):
        smarttestudo.replay(bag, rules, tmp_path / "first", decisions=path)
    assert path.read_text("utf-8") == RULES
    assert not (tmp_path / "first").exists()
    log.touch()
    for output in ("first", "second"):
        smarttestudo.replay(bag, rules, tmp_path / output, decisions=log)
        assert [decision.topic for decision in smarttestudo.read_decisions(log)] == ["/odom"]


def test_one_name_in_place_of_several_is_that_name(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", small_mission(1))
    for topics in ("/odom", ["/odom"], iter(["/odom"]), np.array(["/odom"])):
        report = smarttestudo.measure_loss(bag, bag, topics=topics)
        assert {row["topic"] for row in smarttestudo.rows(report)} == {"/odom"}


@pytest.mark.full
def test_a_recording_may_be_behind_a_url(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", small_mission(1))
    assert smarttestudo.measure_bag(f"file://{bag}").total == smarttestudo.measure_bag(bag).total


def test_numbers_of_arrays_are_numbers(tmp_path: Path) -> None:
    bag, rules = (
        write_bag(tmp_path / "bag", small_mission(1)),
        smarttestudo.read_rules(rule_file(tmp_path, RULES)),
    )
    rows = [
        smarttestudo.rows(smarttestudo.replay(bag, rules, tmp_path / str(number), budget_kb_per_s=budget))
        for number, budget in enumerate((5, np.int32(5), np.float32(5)))
    ]
    assert rows[0] == rows[1] == rows[2]


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: smarttestudo.check_rules(["rules.adirf"]), "rules"),  # type: ignore[arg-type]
        (lambda: smarttestudo.check_rules(""), "rules"),
        (smarttestudo.check_rules, "rules"),
        (smarttestudo.read_rules, "rules"),
        (lambda: smarttestudo.check_rules("rules.adirf", profile={}), "profile"),  # type: ignore[arg-type]
        (lambda: smarttestudo.measure_bag(None), "bag"),  # type: ignore[arg-type]
        (lambda: smarttestudo.measure_bag(b"bag"), "bag"),  # type: ignore[arg-type]
        (lambda: smarttestudo.measure_bag("bag\0"), "bag"),
        (lambda: smarttestudo.measure_bag("bag", latency="no"), "latency"),  # type: ignore[arg-type]
        (lambda: smarttestudo.measure_loss("a", "b", topics=3), "topics"),  # type: ignore[arg-type]
        (lambda: smarttestudo.measure_loss("a", "b", topics=[None]), "topics"),  # type: ignore[list-item]
        (lambda: smarttestudo.read_decisions(3), "path"),  # type: ignore[arg-type]
        (lambda: smarttestudo.rows("abc"), "result"),  # type: ignore[arg-type]
        (lambda: smarttestudo.rows(None), "result"),  # type: ignore[arg-type]
    ],
)
def test_an_argument_of_another_kind_is_an_error_at_its_name(call: Callable[[], object], place: str) -> None:
    with pytest.raises(UsageError, match=f"^{place}: error: .*; ") as raised:
        call()
    assert "\n" not in str(raised.value)
