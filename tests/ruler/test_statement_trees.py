# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules with time, bounds and recordings, in the words of the page and back."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import pytest
from hypothesis import given, settings
from msgspec.structs import replace

from language.written_rules import WrittenFile, written_files
from smarttestudo.domain.rate import Tier
from smarttestudo.editing import EditError
from smarttestudo.editing.difference import differences, mean_the_same
from smarttestudo.editing.document import condition_meaning, meaning
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import Block, DurationUnit, Operator, TimeWord
from smarttestudo.ruler.rules.document import CheckedTexts, Draft, document
from smarttestudo.ruler.rules.edits import EditRequest, Insert, Replace, edit
from smarttestudo.ruler.rules.statements import (
    Action,
    AndCondition,
    CallStatement,
    CheckCondition,
    Condition,
    DurationValue,
    Hz,
    MarginValue,
    NotCondition,
    NotifyStatement,
    ParameterStatement,
    RawStatement,
    RecordStatement,
    RuleStatement,
    SetStatement,
    Statement,
    TimedCondition,
    UntilValue,
    WithinStatement,
)
from smarttestudo.ruler.topics.vocabulary import VocabularyRequest, topics_in, vocabulary

TEXT = """\
begin
    KeepWithin /odom position 0.10  // m
    Rule "Near"  // people
    If ( CheckValue /scan distance  <  0.50  // close
         AND Not CheckValue /odom speed > 1 For 2 s )  // and slow
    Then
        Record "near miss" /scan Before 30 s After 500 ms  // all of it
        SetFrequency /scan 20
        KeepWithin /odom position 0.05 // 5 cm
    EndIf
end
"""
SECONDS = DurationUnit.SECONDS


def statements(text: str) -> Sequence[Statement]:
    return document(Draft(text=text, name="rules.adirf"), CheckedTexts()).collections[0].statements


def rule_in(text: str) -> RuleStatement:
    found = next(one for one in statements(text) if isinstance(one, RuleStatement))
    assert isinstance(found, RuleStatement)
    return found


def edited(statement: Statement, text: str = TEXT) -> str:
    replaced = Replace(id=statement.id, statement=statement)
    return edit(EditRequest(text=text, name="rules.adirf", edits=(replaced,)), CheckedTexts()).text


def with_condition(condition: Condition) -> str:
    return edited(replace(rule_in(TEXT), condition=condition))


def parts() -> tuple[CheckCondition, NotCondition, TimedCondition, CheckCondition]:
    """The first check of the rule, its Not, what is timed in it, and the check in that."""
    both = rule_in(TEXT).condition
    assert isinstance(both, AndCondition)
    first, second = both.terms
    assert isinstance(first, CheckCondition)
    assert isinstance(second, NotCondition)
    timed = second.term
    assert isinstance(timed, TimedCondition)
    assert isinstance(timed.term, CheckCondition)
    return first, second, timed, timed.term


def test_the_page_sees_times_bounds_and_recordings() -> None:
    bound, rule = statements(TEXT)
    assert isinstance(bound, WithinStatement)
    assert (bound.topic, bound.property, bound.bound) == ("/odom", "position", 0.1)
    assert isinstance(rule, RuleStatement)
    record, rate, within = rule.then
    assert isinstance(record, RecordStatement)
    assert (record.name, record.topics) == ("near miss", ("/scan",))
    assert record.before == DurationValue(value=30.0, unit=SECONDS)
    assert record.after == DurationValue(value=500.0, unit=DurationUnit.MILLISECONDS)
    assert isinstance(rate, SetStatement)
    assert isinstance(within, WithinStatement)
    _, _, timed, check = parts()
    assert (timed.word, timed.duration) == (TimeWord.FOR, DurationValue(value=2.0, unit=SECONDS))
    assert (check.property, check.until) == ("speed", None)


@given(written_files())
@settings(max_examples=60)
def test_every_statement_sent_back_as_it_came_leaves_the_same_bytes(written: WrittenFile) -> None:
    texts = CheckedTexts()
    for part in document(Draft(text=written.text, name="rules.adirf"), texts).collections:
        assert not any(isinstance(one, RawStatement) for one in part.statements)
        edits = tuple(Replace(id=one.id, statement=one) for one in part.statements)
        request = EditRequest(text=written.text, name="rules.adirf", edits=edits)
        assert edit(request, texts).text == written.text


@given(written_files())
@settings(max_examples=60)
def test_every_statement_written_anew_from_its_json_means_what_it_meant(written: WrittenFile) -> None:
    texts = CheckedTexts()
    page = document(Draft(text=written.text, name="rules.adirf"), texts)
    sent = msgspec.json.encode([one for part in page.collections for one in part.statements])
    inserts = tuple(
        Insert(collection="c1", index=index, statement=one)
        for index, one in enumerate(msgspec.json.decode(sent, type=list[Statement]))
    )
    anew = edit(EditRequest(text="begin\nend\n", name="rules.adirf", edits=inserts), texts).text
    assert [*map(meaning, parse(anew, "anew.adirf").file.statements)] == [
        *map(meaning, parse(written.text, "rules.adirf").file.statements)
    ]


ACTS = """\
begin
    SetFrequency /scan 2.0 .. 20 Hz By /scan distance 3 .. 0.50  // near
    If CheckValue /mode data = "docking"  // word
    Then
        SetParameter /controller max_speed 1.0  // m/s
        Call /light true
        Notify "at \\"B\\""
    EndIf
end
"""


def test_the_page_has_margins_words_and_actions() -> None:
    rate, rule = statements(ACTS)
    assert isinstance(rate, SetStatement)
    assert rate.margin == MarginValue(
        to=Hz(value=20), topic="/scan", property="distance", from_value=3, to_value=0.5
    )
    assert isinstance(rule, RuleStatement)
    assert isinstance(rule.condition, CheckCondition)
    assert rule.condition.value == '"docking"'
    parameter, call, notify = rule.then
    assert isinstance(parameter, ParameterStatement)
    assert (parameter.node, parameter.parameter, parameter.value) == ("/controller", "max_speed", "1.0")
    assert isinstance(call, CallStatement)
    assert (call.service, call.argument) == ("/light", True)
    assert isinstance(notify, NotifyStatement)
    assert notify.text == 'at "B"'


def test_margins_words_and_actions_change_with_everything_else_untouched() -> None:
    rate, rule = statements(ACTS)
    assert isinstance(rate, SetStatement)
    assert rate.margin is not None
    nearer = replace(rate, margin=replace(rate.margin, to_value=0.25))
    assert edited(nearer, ACTS) == ACTS.replace("20 Hz By", "20 By").replace("0.50", "0.25")
    assert edited(replace(rate, margin=None), ACTS) == ACTS.replace(
        " .. 20 Hz By /scan distance 3 .. 0.50", ""
    )
    assert isinstance(rule, RuleStatement)
    assert isinstance(rule.condition, CheckCondition)
    for value, written in (("true", "true"), (1.0, "1"), ("GoalStatus.STATUS_ABORTED",) * 2, ('"a"', '"a"')):
        changed = edited(replace(rule, condition=replace(rule.condition, value=value)), ACTS)
        assert changed == ACTS.replace('"docking"', written)
    parameter, call, notify = rule.then
    assert isinstance(parameter, ParameterStatement)
    assert isinstance(call, CallStatement)
    whole = edited(replace(rule, then=(replace(parameter, value="1"), call, notify)), ACTS)
    assert whole == ACTS.replace("1.0  // m/s", "1  // m/s")
    silent = edited(replace(rule, then=(parameter, replace(call, argument=None), notify)), ACTS)
    assert silent == ACTS.replace("/light true", "/light")


@pytest.mark.parametrize("value", ["docking", '"a" "b"', "", "1 2"])
def test_what_no_rule_can_compare_with_is_refused(value: str) -> None:
    first, negated, _, _ = parts()
    with pytest.raises(EditError, match="no number, text in quotes, constant, true or false"):
        with_condition(AndCondition(terms=(replace(first, value=value), negated)))


def test_true_is_another_comparison_than_1() -> None:
    text = ACTS.replace('"docking"', "1")
    _, rule = statements(text)
    assert isinstance(rule, RuleStatement)
    assert isinstance(rule.condition, CheckCondition)
    changed = edited(replace(rule, condition=replace(rule.condition, value="true")), text)
    assert changed == text.replace("= 1", "= true")


TIMES = [
    (TimeWord.FOR, 10, SECONDS, "For 10 s"),
    (TimeWord.WITHIN, 0.5, DurationUnit.MINUTES, "Within 0.5 min"),
]


@pytest.mark.parametrize(("word", "value", "unit", "written"), TIMES)
def test_a_time_comes_and_goes_without_touching_anything_else(
    word: TimeWord, value: float, unit: DurationUnit, written: str
) -> None:
    first, negated, timed, check = parts()

    def of(term: Condition) -> TimedCondition:
        return TimedCondition(term=term, word=word, duration=DurationValue(value=value, unit=unit))

    on_check = with_condition(AndCondition(terms=(of(first), negated)))
    assert on_check == TEXT.replace("0.50 ", f"0.50 {written} ")
    assert edited(rule_in(TEXT), on_check) == TEXT
    on_both = with_condition(of(AndCondition(terms=(first, negated))))
    assert on_both == TEXT.replace("2 s )", f"2 s ) {written}")
    assert edited(rule_in(TEXT), on_both) == TEXT
    on_not = with_condition(AndCondition(terms=(first, of(negated))))
    assert on_not == TEXT.replace(
        "Not CheckValue /odom speed > 1 For 2 s", f"(Not CheckValue /odom speed > 1 For 2 s) {written}"
    )
    outside = with_condition(AndCondition(terms=(first, NotCondition(term=of(timed)))))
    assert outside == TEXT.replace("For 2 s", f"For 2 s {written}")
    instead = with_condition(AndCondition(terms=(first, NotCondition(term=of(check)))))
    assert instead == TEXT.replace("For 2 s", written)


def test_an_end_comes_changes_and_goes_without_touching_anything_else() -> None:
    first, negated, _, _ = parts()
    ended = replace(first, until=UntilValue(op=Operator.GREATER, value=0.75))
    text = with_condition(AndCondition(terms=(ended, negated)))
    assert text == TEXT.replace("0.50 ", "0.50 Until > 0.75 ")
    later = replace(first, until=UntilValue(op=Operator.GREATER_EQUAL, value=1))
    rule = replace(rule_in(TEXT), condition=AndCondition(terms=(later, negated)))
    assert edited(rule, text) == TEXT.replace("0.50 ", "0.50 Until >= 1 ")
    assert edited(rule_in(TEXT), text) == TEXT


def test_a_comment_in_the_way_of_a_change_is_kept() -> None:
    text = TEXT.replace("> 1 For 2 s", "> 1 // how fast\n        For 2 s")
    first, _, _, check = parts()
    rule = replace(rule_in(TEXT), condition=AndCondition(terms=(first, NotCondition(term=check))))
    changed = edited(rule, text)
    assert all(comment in changed for comment in ("// how fast", "// close", "// and slow", "// all of it"))
    assert "For" not in changed


def test_bounds_and_recordings_change_word_by_word() -> None:
    bound, rule = statements(TEXT)
    assert isinstance(bound, WithinStatement)
    assert isinstance(rule, RuleStatement)
    assert edited(replace(bound, property="orientation", bound=5.0)) == TEXT.replace(
        "position 0.10", "orientation 5"
    )
    record, rate, within = rule.then
    assert isinstance(record, RecordStatement)
    named = replace(
        record, name='a "close" one', topics=("/scan", "/odom"), after=DurationValue(value=2, unit=SECONDS)
    )
    changed = edited(replace(rule, then=(named, rate, within)))
    assert changed == TEXT.replace('"near miss" /scan', r'"a \"close\" one" /scan /odom').replace(
        "500 ms", "2 s"
    )
    fewer = replace(rule, then=(replace(record, topics=()), rate, within))
    assert edited(fewer) == TEXT.replace('"near miss" /scan', '"near miss"')


def test_an_action_that_goes_takes_its_line_alone() -> None:
    odd = TEXT.replace("SetFrequency /scan 20", "SetFrequency   /scan 20")
    rule = rule_in(odd)
    record, _, bound = rule.then
    gone = odd.replace("        SetFrequency   /scan 20\n", "")
    assert edited(replace(rule, then=(record, bound)), odd) == gone
    alone = edited(replace(rule, then=(record,)), odd)
    assert alone == gone.replace("        KeepWithin /odom position 0.05 // 5 cm\n", "")


def test_actions_in_another_order_keep_their_comments() -> None:
    rule = rule_in(TEXT)
    changed = edited(replace(rule, then=rule.then[::-1]))
    assert [type(one) for one in rule_in(changed).then] == [type(one) for one in rule.then[::-1]]
    assert all(comment in changed for comment in ("// all of it", "// 5 cm", "// close", "// people"))


def test_of_actions_in_another_order_only_the_changed_one_is_written_anew() -> None:
    rule = rule_in(TEXT)
    record, rate, within = rule.then
    assert isinstance(rate, SetStatement)
    assert isinstance(within, WithinStatement)
    text = TEXT.replace("0.05 //", "5e-2 //")
    changed = edited(replace(rule, then=(within, replace(rate, rate=Hz(value=5)), record)), text)
    assert "SetFrequency /scan 5\n" in changed
    assert "KeepWithin /odom position 5e-2  // 5 cm" in changed
    changed = edited(replace(rule, then=(replace(within, bound=0.2), rate, record)), text)
    assert "KeepWithin /odom position 0.2  // 5 cm" in changed


def test_a_copied_rule_has_all_that_the_rule_has() -> None:
    rule = rule_in(TEXT)
    (collection,) = document(Draft(text=TEXT, name="rules.adirf"), CheckedTexts()).collections
    insert = Insert(collection=collection.id, index=2, statement=replace(rule, name="Copy"))
    text = edit(EditRequest(text=TEXT, name="rules.adirf", edits=(insert,)), CheckedTexts()).text
    assert differences(parse(TEXT, "a"), parse(text, "b")) == ("Copy: added",)
    copied = [one for one in statements(text) if isinstance(one, RuleStatement)][1]
    assert said(copied.then) == said(rule.then)
    assert meanings_of(text)[-1] == meanings_of(TEXT)[-1]


def meanings_of(text: str) -> list[object]:
    """What the conditions of the rules of a text mean."""
    rules = parse(text, "rules.adirf").file.statements
    return [condition_meaning(one.condition) for one in rules if isinstance(one, Block)]


def said(actions: tuple[Action, ...]) -> list[Action]:
    return [replace(one, comments=(), offset=0, end_offset=0, line=0) for one in actions]


def test_a_bound_may_be_a_level() -> None:
    bound = statements(TEXT)[0]
    assert isinstance(bound, WithinStatement)
    level = replace(bound, bound=Tier.ACCEPTABLE)
    assert "KeepWithin /odom position Acceptable" in edited(level)


@pytest.mark.parametrize(
    ("duration", "problem"),
    [
        (DurationValue(value=25 * 60, unit=DurationUnit.MINUTES), "between 0 and 1440 min"),
        (DurationValue(value=-1, unit=SECONDS), "between 0 and 1440 min"),
        (DurationValue(value=1e300, unit=SECONDS), "between 0 and 1440 min"),
    ],
)
def test_a_time_that_the_language_cannot_say_is_refused(duration: DurationValue, problem: str) -> None:
    first, _, timed, _ = parts()
    with pytest.raises(EditError, match=problem):
        with_condition(AndCondition(terms=(first, replace(timed, duration=duration))))


def test_a_push_says_what_is_recorded_anew() -> None:
    before, after = parse(TEXT, "a"), parse(TEXT.replace("Before 30 s", "Before 20 s"), "b")
    assert not mean_the_same(before, after)
    assert differences(before, after) == (
        'Near: Record "near miss" removed',
        'Near: Record "near miss" added',
    )
    spelled = parse(TEXT.replace("500 ms", "0.5 s"), "c")
    assert mean_the_same(before, spelled)
    assert differences(before, spelled) == ()


def test_a_rate_in_a_rule_changes_alone() -> None:
    rule = rule_in(TEXT)
    record, _, within = rule.then
    faster = replace(rule, then=(record, SetStatement(topic="/scan", rate=Hz(value=40)), within))
    assert edited(faster) == TEXT.replace("/scan 20", "/scan 40")


def test_topics_that_are_only_bounded_in_a_rule_are_known_to_the_page() -> None:
    assert "/map" in topics_in(parse(TEXT.replace("Record", "KeepWithin /map x 1 Record"), "a"))


def test_topics_that_are_only_recorded_are_known_to_the_page() -> None:
    assert "/map" in topics_in(parse(TEXT.replace("/scan Before", "/scan /map Before"), "a"))


def test_the_machine_and_the_link_are_words_of_their_own_and_no_topics() -> None:
    text = "begin If (CheckValue @machine cpu > 9 AND CheckValue @link used > 9) Then SetFrequency /a 1 end"
    words = vocabulary(VocabularyRequest(text=text), dict)
    assert topics_in(parse(text, "a")) == {"/a"}
    assert not any(one.topic.startswith("@") for one in words.topics)
    assert {one.name: [each.name for each in one.properties] for one in words.vitals} == {
        "@machine": ["cpu", "memory", "temperature", "disk_free", "wifi_signal"],
        "@link": ["capacity", "round_trip", "used", "connected", "age"],
    }


def test_the_page_suggests_what_only_a_bound_can_name() -> None:
    (odom,) = (one for one in vocabulary(VocabularyRequest(), dict).topics if one.topic == "/odom")
    assert [(one.name, one.unit) for one in odom.bounds] == [("position", "m"), ("orientation", "°")]
    assert "position" not in [one.name for one in odom.properties]
