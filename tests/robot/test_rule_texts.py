# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The texts in force, as others read them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.remote_robots import RuleText, RuleTexts

texts = st.builds(
    RuleTexts,
    sha256=st.text(),
    files=st.lists(st.builds(RuleText, st.text(), st.text())).map(tuple),
    full_names=st.dictionaries(st.text(), st.text()),
)


@given(texts)
def test_what_is_written_is_read(rules: RuleTexts) -> None:
    assert RuleTexts.from_text(rules.to_text()) == rules


@pytest.mark.parametrize(
    "text", ["", "None", "[]", "{}", '{"sha256": 1, "files": 5, "full_names": {}}', "[" * 99999]
)
def test_what_is_none_of_it_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        RuleTexts.from_text(text)


def test_files_that_end_in_a_comment_do_not_swallow_the_next() -> None:
    rules = RuleTexts(files=(RuleText("a", "begin end // a"), RuleText("b", "begin end")))
    assert rules.text == "begin end // a\nbegin end"
