# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page's answer to an edited text is that to a text that was never seen before."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from checks.test_edited_rules_laws import block, other
from checks.test_edited_rules_laws import edited as edited_rules
from language.edited_texts import edited_texts
from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.answers.answer_json import answer_json
from smarttestudo.ruler.answers.checked_text import Draft
from smarttestudo.ruler.answers.documents import RuleDocument
from smarttestudo.ruler.answers.edits import Delete, Duplicate, Edit, EditedTexts, EditRequest, Replace
from smarttestudo.ruler.answers.statements import RuleStatement


@given(edited_texts())
@settings(max_examples=150)
def test_the_document_of_an_edited_text_is_as_if_it_were_new(texts: list[str]) -> None:
    kept = EditedTexts()
    for text in texts:
        draft = Draft(text=text, name="rules.adirf")
        assert answer_json(kept.document(draft)) == answer_json(EditedTexts().document(draft))
        assert answer_json(kept.zones(draft)) == answer_json(EditedTexts().zones(draft))


@given(edited_texts(), st.sampled_from((None, "")))
@settings(max_examples=150, deadline=None)
def test_the_json_of_an_edited_text_is_that_of_its_statements_and_findings(
    texts: list[str], profile_text: str | None
) -> None:
    kept = EditedTexts()
    for text in texts:
        check_json(kept.document(Draft(text=text, name="rules.adirf", profile_text=profile_text)))


@given(st.integers(0, 2**32))
@settings(max_examples=50, deadline=None)
def test_the_json_of_rules_that_clash_is_that_of_their_statements_and_findings(seed: int) -> None:
    random = Random(seed)
    kept = EditedTexts()
    parts = [random.choice((block, block, block, other))(random) for _ in range(random.randrange(1, 25))]
    for _ in range(random.randrange(2, 9)):
        draft = Draft(text=f"begin\n{''.join(parts)}end\n", name="rules.adirf", profile_text="")
        check_json(kept.document(draft))
        parts = edited_rules(parts, random)


@given(edited_texts(max_edits=3))
@settings(max_examples=100, deadline=None)
def test_a_statement_of_an_edited_text_is_edited_as_if_the_text_were_new(texts: list[str]) -> None:
    kept = EditedTexts()
    for text in texts:
        draft = Draft(text=text, name="rules.adirf")
        for edit in edits_of(kept.document(draft)):
            request = EditRequest(text=text, name=draft.name, edits=(edit, edit))
            assert edited(kept, request) == edited(EditedTexts(), request)


def check_json(document: RuleDocument) -> None:
    parts = [replace(part, statements=tuple(part.statements)) for part in document.collections]
    structs = replace(document, collections=tuple(parts), findings=tuple(document.findings))
    assert answer_json(document).decode() == answer_json(structs).decode()


def edits_of(document: RuleDocument) -> Iterator[Edit]:
    """Some edits of the last statement."""
    last = [statement for part in document.collections for statement in part.statements][-1:]
    for one in last:
        yield from (Delete(id=one.id), Duplicate(id=one.id))
        if isinstance(one, RuleStatement):
            yield Replace(id=one.id, statement=replace(one, is_disabled=not one.is_disabled, priority=3))


def edited(texts: EditedTexts, request: EditRequest) -> object:
    try:
        return answer_json(texts.edit(request))
    except TestudoError as error:
        return str(error)
