# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule that records, in the words of the page and back."""

from __future__ import annotations

from msgspec.structs import replace

from smarttestudo.adirf.parser import parse
from smarttestudo.adirf.syntax import Block, SetFrequency
from smarttestudo.use_cases.ruler.checked_text import Draft
from smarttestudo.use_cases.ruler.difference import differences, mean_the_same
from smarttestudo.use_cases.ruler.edits import EditedTexts, EditRequest, Replace
from smarttestudo.use_cases.ruler.sharing import ExportRequest, exported
from smarttestudo.use_cases.ruler.statements import (
    Hz,
    RawStatement,
    RecordStatement,
    RuleStatement,
    SetStatement,
)
from smarttestudo.use_cases.ruler.vocabulary import topics_in

TEXT = """\
begin
    SetFrequency /scan 5
    If CheckValue /scan distance < 0.5
    Then
        Record "near miss" /scan Before 30 s After 500 ms  // all of it
        SetFrequency /scan 20
    EndIf
end
"""


def rule_in(text: str) -> RuleStatement:
    document = EditedTexts().document(Draft(text=text, name="rules.adirf"))
    found = document.collections[0].statements[1]
    assert isinstance(found, RuleStatement)
    return found


def edited(rule: RuleStatement) -> str:
    edit = Replace(id=rule.id, statement=rule)
    return EditedTexts().edit(EditRequest(text=TEXT, name="rules.adirf", edits=(edit,))).text


def test_the_page_sees_what_is_recorded() -> None:
    rule = rule_in(TEXT)
    assert rule.then_records == (
        RecordStatement(name="near miss", topics=("/scan",), before_s=30.0, after_s=0.5),
    )
    assert [one.topic for one in rule.then] == ["/scan"]


def test_a_page_that_knows_nothing_of_records_loses_none() -> None:
    rule = replace(rule_in(TEXT), then_records=None, else_records=None)
    assert edited(rule) == TEXT
    faster = replace(rule, then=(SetStatement(topic="/scan", rate=Hz(value=40)),))
    assert edited(faster) == TEXT.replace("/scan 20", "/scan 40")


def test_a_rule_sent_back_as_it_came_stays_as_it_is() -> None:
    assert edited(rule_in(TEXT)) == TEXT


def test_a_record_is_changed_and_removed() -> None:
    rule = rule_in(TEXT)
    other = RecordStatement(name="near miss", topics=("/scan", "/odom"), before_s=30.0, after_s=2.0)
    changed = edited(replace(rule, then_records=(other,)))
    assert 'Record "near miss" /scan /odom Before 30 s After 2 s  // all of it' in changed
    assert "Record" not in edited(replace(rule, then_records=()))


def test_a_push_says_what_is_recorded_anew() -> None:
    before, after = parse(TEXT, "a"), parse(TEXT.replace("Before 30 s", "Before 20 s"), "b")
    assert not mean_the_same(before, after)
    assert differences(before, after) == (
        'unnamed rule 1: Record "near miss" removed',
        'unnamed rule 1: Record "near miss" added',
    )
    spelled = parse(TEXT.replace("500 ms", "0.5 s"), "c")
    assert mean_the_same(before, spelled)
    assert differences(before, spelled) == ()


def test_a_rule_that_is_shown_as_text_loses_nothing_either() -> None:
    text = TEXT.replace("< 0.5", "< 0.5 For 2 s").replace(
        "Record", "KeepWithin /odom position 0.1\n        Record"
    )
    document = EditedTexts().document(Draft(text=text, name="rules.adirf"))
    shown = document.collections[0].statements[1]
    assert isinstance(shown, RawStatement)
    assert all(word in shown.text for word in ("For 2 s", "KeepWithin /odom position 0.1", "Before 30 s"))
    kept = EditRequest(text=text, name="rules.adirf", edits=(Replace(id=shown.id, statement=shown),))
    assert EditedTexts().edit(kept).text == text


def test_a_rule_in_the_place_of_text_with_a_bound_keeps_the_bound() -> None:
    text = TEXT.replace("        Record", "        KeepWithin /odom position 0.1\n        Record")
    edit = Replace(id=rule_in(TEXT).id, statement=replace(rule_in(TEXT), then_records=None))
    assert EditedTexts().edit(EditRequest(text=text, name="rules.adirf", edits=(edit,))).text == text


def test_an_export_keeps_apart_what_stood_in_two_collections() -> None:
    rule = "If CheckValue /scan distance < 1 Then SetFrequency /scan 9"
    text = f"begin\n    {rule}\nend\nbegin\n    SetFrequency /odom 1\nend\n"
    both = exported(ExportRequest(text=text, name="rules.adirf", ids=("s1", "s2")))
    assert [type(one) for one in parse(both, "a").file.statements] == [Block, SetFrequency]


def test_topics_that_are_only_bounded_in_a_rule_are_known_to_the_page() -> None:
    assert "/map" in topics_in(parse(TEXT.replace("Record", "KeepWithin /map x 1 Record"), "a"))


def test_topics_that_are_only_recorded_are_known_to_the_page() -> None:
    assert "/map" in topics_in(parse(TEXT.replace("/scan Before", "/scan /map Before"), "a"))
