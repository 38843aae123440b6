# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page's answer to an edited text is that to a text that was never seen before."""

from __future__ import annotations

from hypothesis import given, settings

from language.edited_texts import edited_texts
from smarttestudo.ruler.answers.answer_json import answer_json
from smarttestudo.ruler.answers.checked_text import Draft
from smarttestudo.ruler.answers.edits import EditedTexts


@given(edited_texts())
@settings(max_examples=150)
def test_the_document_of_an_edited_text_is_as_if_it_were_new(texts: list[str]) -> None:
    kept = EditedTexts()
    for text in texts:
        draft = Draft(text=text, name="rules.adirf")
        assert answer_json(kept.document(draft)) == answer_json(EditedTexts().document(draft))
