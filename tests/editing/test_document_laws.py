# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for edits of statements whatever the file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from language.rule_strategies import blocks, keep_at_leasts, set_frequencies
from language.written_rules import WrittenFile, written_files
from smarttestudo.editing import (
    Document,
    Entry,
    NewStatement,
    deleted,
    duplicated,
    inserted,
    meaning,
    moved,
    read_document,
    replaced,
)
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import Block, Comment, Statement

ANY_TEXT = st.text(alphabet="begindSEftR()<>=!&|/\"'#*\\ \n\r\t.-0123456789", max_size=60)
STATEMENTS = st.one_of(set_frequencies(), keep_at_leasts(), blocks())
FILES_WITH_STATEMENTS = written_files().filter(lambda written: any(statements_of(written)))
FILES_WITH_RULES = written_files().filter(
    lambda written: any(isinstance(one, Block) for one in statements_of(written))
)


def statements_of(written: WrittenFile) -> list[Statement]:
    return [one for collection in written.tree.collections for one in collection.statements]


def statement_of(entry: Entry) -> Statement:
    assert entry.statement is not None
    return entry.statement


def document_of(text: str) -> Document:
    return read_document(text, "rules.adirf")


def meanings(text: str) -> list[list[object]]:
    result = parse(text, "rules.adirf")
    assert result.findings == (), text
    return [[meaning(one) for one in part.statements] for part in result.file.collections]


def words(entry: Entry) -> str:
    return entry.token_range.text[entry.token_range.start : entry.token_range.end]


def comments(text: str) -> list[str]:
    tokens = parse(text, "rules.adirf").tokens
    found: list[Comment] = [
        comment for token in tokens for comment in (*token.above, *((token.beside,) if token.beside else ()))
    ]
    return sorted(comment.text for comment in found)


@given(written_files())
@settings(max_examples=60)
def test_a_valid_file_is_shown_statement_by_statement(written: WrittenFile) -> None:
    document = document_of(written.text)
    shown = [[entry.statement for entry in part.entries] for part in document.parts]
    assert shown == [list(part.statements) for part in document.result.file.collections]


@given(st.one_of(ANY_TEXT, st.builds(lambda w, cut: w.text[cut:], written_files(), st.integers(0, 80))))
@settings(max_examples=60)
def test_every_word_of_any_text_is_in_a_statement_or_is_begin_or_end(text: str) -> None:
    document = document_of(text)
    shown = [offset for entry in document.entries for offset in entry.token_range.offsets]
    assert shown == sorted(set(shown))
    words = dict(zip(document.words.offsets, document.words.tokens, strict=True))
    begins = {part.begin.start for part in document.parts if part.begin is not None}
    misspelt = {
        document.places.range(finding.span)[0]
        for finding in document.result.findings
        if finding.code == "expected-begin"
    }
    # What stands for a misspelt begin is no statement.
    assert all(words[offset].text == "begin" or offset in misspelt for offset in begins)
    frame = begins | {part.end - len("end") for part in document.parts}
    left_out = words.keys() - shown
    assert left_out <= frame
    assert {words[offset].text for offset in left_out - begins} <= {"end"}


@given(FILES_WITH_STATEMENTS, st.data())
@settings(max_examples=60)
def test_a_statement_replaced_by_itself_leaves_the_same_bytes(
    written: WrittenFile, data: st.DataObject
) -> None:
    document = document_of(written.text)
    for entry in document.entries:
        assert replaced(document, entry.id, NewStatement(content=statement_of(entry))) == written.text


@given(FILES_WITH_STATEMENTS, STATEMENTS, st.data())
@settings(max_examples=60)
def test_a_replaced_statement_says_the_new_and_all_others_keep_their_bytes(
    written: WrittenFile, new: Statement, data: st.DataObject
) -> None:
    document = document_of(written.text)
    at = data.draw(st.integers(0, len(document.entries) - 1))
    entry = document.entries[at]
    text = replaced(document, entry.id, NewStatement(content=new))
    after = document_of(text)
    assert after.result.findings == (), text
    assert [meaning(statement_of(one)) for one in after.entries] == [
        meaning(new if index == at else statement_of(one)) for index, one in enumerate(document.entries)
    ]
    assert_others_kept(document, after, [one for i, one in enumerate(document.entries) if i != at], at)


def assert_others_kept(before: Document, after: Document, others: Sequence[Entry], skipped: int) -> None:
    left = [one for index, one in enumerate(after.entries) if index != skipped]
    for one, other in zip(others, left, strict=True):
        # The one thing that may be added is an EndIf.
        assert words(other).startswith(words(one))
        assert words(other)[len(words(one)) :].split("\n")[-1].strip() in ("", "EndIf")


def test_what_a_rule_says_twice_keeps_the_comment_of_each() -> None:
    # A comment before the name has the whole rule written anew.
    text = """begin
    Rule // of the name
    "Far" If (
        CheckValue /odom pose_x > 1
        // again
        AND CheckValue /odom pose_x > 1
    )
    Then
        SetFrequency /odom 5  // here
    Else
        SetFrequency /odom 5  // there
    EndIf
end
"""
    document = document_of(text)
    (entry,) = document.entries
    rule = statement_of(entry)
    assert isinstance(rule, Block)
    changed = replaced(document, entry.id, NewStatement(content=replace(rule, name="New", label="New")))
    assert '"New"' in changed
    assert comments(changed) == comments(text)


def test_a_comment_at_the_end_of_a_rule_hides_nothing_behind_it() -> None:
    text = """begin If // why
CheckValue /odom pose_x > 1
Then SetFrequency /odom 5 // here
Else SetFrequency // there
/odom 6 end
"""
    document = document_of(text)
    (entry,) = document.entries
    rule = statement_of(entry)
    assert isinstance(rule, Block)
    changed = replaced(document, entry.id, NewStatement(content=replace(rule, otherwise=())))
    assert parse(changed, "rules.adirf").findings == ()
    assert "// here\n" in changed


@given(FILES_WITH_RULES, st.data())
@settings(max_examples=60)
def test_a_small_change_of_a_rule_keeps_all_its_comments(written: WrittenFile, data: st.DataObject) -> None:
    document = document_of(written.text)
    rules = [(one, one.statement) for one in document.entries if isinstance(one.statement, Block)]
    entry, old = data.draw(st.sampled_from(rules))
    # No topic may be set twice.
    new = data.draw(blocks(topics=("/added", "/added_too")))
    change = data.draw(st.sampled_from(["then", "otherwise", "name", "priority", "switch", "all sets"]))
    match change:
        case "then":
            block = replace(old, then=(*old.then, *new.then))
        case "otherwise":
            block = replace(old, otherwise=new.otherwise)
        case "name":
            block = replace(old, name="New", label="New")
        case "priority":
            block = replace(old, priority=7, name=old.name or "N")
        case "switch":
            block = replace(old, is_disabled=not old.is_disabled)
        case _:
            block = replace(old, then=new.then)
    text = replaced(document, entry.id, NewStatement(content=block))
    if change in ("then", "name", "priority", "switch"):
        assert comments(text) == comments(written.text)
    assert meanings(text) == [
        [meaning(block if one is entry else statement_of(one)) for one in part.entries]
        for part in document.parts
    ]


@given(FILES_WITH_STATEMENTS, st.data())
@settings(max_examples=60)
def test_a_copy_says_the_same_under_a_name_of_its_own_and_all_others_keep_their_bytes(
    written: WrittenFile, data: st.DataObject
) -> None:
    document = document_of(written.text)
    at = data.draw(st.integers(0, len(document.entries) - 1))
    entry = document.entries[at]
    after = document_of(duplicated(document, entry.id))
    assert after.result.findings == (), after.text
    old, copy = statement_of(entry), statement_of(after.entries[at + 1])
    if isinstance(old, Block) and isinstance(copy, Block) and old.name is not None:
        names = {one.statement.name for one in document.entries if isinstance(one.statement, Block)}
        assert copy.name not in names
        copy = replace(copy, name=old.name)
    assert meaning(copy) == meaning(old)
    assert [one.text for one in after.entries[at + 1].comments] == [one.text for one in entry.comments]
    assert_others_kept(document, after, document.entries, at + 1)


def test_copies_of_copies_count_on() -> None:
    text = 'begin Rule "A 2" If CheckValue /odom speed > 1 Then SetFrequency /odom 2 EndIf end'
    for _ in range(2):
        text = duplicated(document_of(text), "s1")
    names = [one.statement.name for one in document_of(text).entries if isinstance(one.statement, Block)]
    assert names == ["A 2", "A 4", "A 3"]


@given(FILES_WITH_STATEMENTS, st.data())
@settings(max_examples=60)
def test_a_deleted_statement_takes_nothing_else_along(written: WrittenFile, data: st.DataObject) -> None:
    document = document_of(written.text)
    at = data.draw(st.integers(0, len(document.entries) - 1))
    text = deleted(document, document.entries[at].id)
    after = document_of(text)
    assert after.result.findings == (), text
    others = [one for index, one in enumerate(document.entries) if index != at]
    assert [meaning(statement_of(one)) for one in after.entries] == [
        meaning(statement_of(one)) for one in others
    ]
    assert_others_kept(document, after, others, -1)


@given(written_files(), STATEMENTS, st.data())
@settings(max_examples=60)
def test_an_inserted_statement_stands_where_it_was_put(
    written: WrittenFile, new: Statement, data: st.DataObject
) -> None:
    document = document_of(written.text)
    part = data.draw(st.sampled_from(document.parts))
    index = data.draw(st.integers(0, len(part.entries)))
    if isinstance(new, Block):
        new = replace(new, has_end_if=True)
    text = inserted(document, part.id, index, NewStatement(content=new, comments=["why", ""]))
    expected = meanings(written.text)
    expected[document.parts.index(part)].insert(index, meaning(new))
    assert meanings(text) == expected
    assert comments(text) == sorted([*comments(written.text), "// why", "//"])


@given(FILES_WITH_STATEMENTS, st.data())
@settings(max_examples=60)
def test_a_moved_statement_goes_as_it_is_written(written: WrittenFile, data: st.DataObject) -> None:
    document = document_of(written.text)
    entry = data.draw(st.sampled_from(document.entries))
    part = data.draw(st.sampled_from(document.parts))
    count = len([one for one in part.entries if one is not entry])
    index = data.draw(st.integers(0, count))
    text = moved(document, entry.id, part.id, index)
    expected = [
        [meaning(statement_of(one)) for one in each.entries if one is not entry] for each in document.parts
    ]
    expected[document.parts.index(part)].insert(index, meaning(statement_of(entry)))
    assert meanings(text) == expected
    assert comments(text) == comments(written.text)
    assert words(entry) in text


@cache
@st.composite
def damaged_texts(draw: st.DrawFn) -> str:
    """A rule file with a few of its words taken out, doubled or misspelt."""
    text = draw(written_files(max_statements=4)).text
    for _ in range(draw(st.integers(1, 3))):
        tokens = parse(text, "rules.adirf").tokens[:-1]
        token = draw(st.sampled_from(tokens)) if tokens else None
        if token is None:
            break
        at = document_of(text).places.offset(token.line, token.column)
        word = draw(st.sampled_from(["", "x", f"{token.text} {token.text}", token.text[:-1], "end", "If ("]))
        text = f"{text[:at]}{word} {text[at + len(token.text) :]}"
    return text


def test_an_edit_that_changes_nothing_does_not_close_the_block_above() -> None:
    block = "If CheckValue /odom pose_x > 0 Then SetFrequency /odom 1"
    document = document_of(f"begin\n{block}\nKeepAtLeast /odom 1\nend\n")
    entry = document.entries[1]
    assert entry.statement is not None
    assert replaced(document, entry.id, NewStatement(content=entry.statement)) == document.text


@given(damaged_texts(), STATEMENTS, st.data())
@settings(max_examples=100)
def test_edits_of_a_damaged_file_keep_every_other_statement(
    text: str, new: Statement, data: st.DataObject
) -> None:
    document = document_of(text)
    kept = [words(entry) for entry in document.entries]
    assume(kept)
    entry = data.draw(st.sampled_from(document.entries))
    others = [text for one, text in zip(document.entries, kept, strict=True) if one is not entry]
    content = entry.statement or words(entry)
    assert replaced(document, entry.id, NewStatement(content=content)) == text
    for after in (
        deleted(document, entry.id),
        replaced(document, entry.id, NewStatement(content=new)),
        replaced(document, entry.id, NewStatement(content="If (")),
    ):
        assert all(one in after for one in others)
    writable = [part for part in document.parts if part.begin is not None]
    assume(writable)
    part = data.draw(st.sampled_from(writable))
    index = data.draw(st.integers(0, len(part.entries)))
    after = inserted(document, part.id, index, NewStatement(content=new))
    assert all(one in after for one in kept)
