# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live loop was given is on disk, and is read again as it was."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.observation import (
    LinkBudget,
    ListenersChanged,
    ReceiversReckon,
    SourceChanged,
    Undecodable,
    VitalsMeasured,
)
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.loop.input_log import INPUTS_FILE, input_log, read_inputs
from smarttestudo.loop.inputs import (
    ChangeInput,
    GraphInput,
    MessageInput,
    RecordedInput,
    RuleTextsInput,
    WakeInput,
)
from smarttestudo.pacing.sample import WhenSlow

stamps_ns = st.integers(0, 2**62)
counts = st.integers(0, 2**31)
texts = st.text()
budgets = st.floats(0, 1e9)
sources = st.builds(
    SourceChanged, topic=texts, publishers=counts, transient_local=st.booleans(), type_name=texts
)
listeners = st.builds(ListenersChanged, topic=texts, are_there=st.booleans())
inputs = st.one_of(
    st.builds(WakeInput, stamp_ns=stamps_ns),
    st.builds(
        GraphInput,
        stamp_ns=stamps_ns,
        sources=st.lists(sources, max_size=3).map(tuple),
        listeners=st.lists(listeners, max_size=3).map(tuple),
    ),
    st.builds(
        ChangeInput,
        stamp_ns=stamps_ns,
        change=st.one_of(
            sources,
            listeners,
            st.builds(ReceiversReckon, topics=st.frozensets(texts, max_size=3)),
            st.builds(LinkBudget, link_kb_per_s=budgets),
            st.builds(
                VitalsMeasured, source=texts, values=st.dictionaries(texts, st.none() | budgets, max_size=3)
            ),
        ),
    ),
    st.builds(
        MessageInput,
        stamp_ns=stamps_ns,
        topic=texts,
        size_bytes=counts,
        payload=st.binary(),
        message=st.none() | st.just(Undecodable()),
        publisher=st.none() | counts,
    ),
    st.builds(
        RuleTextsInput,
        stamp_ns=stamps_ns,
        rule_texts=st.dictionaries(texts, texts),
        profile_text=st.none() | texts,
        names=st.dictionaries(texts, texts),
        when_slow=st.sampled_from(WhenSlow),
        budget_kb_per_s=st.none() | budgets,
        relay_all=st.none() | st.lists(texts).map(tuple),
    ),
)


def write(folder: Path, given_inputs: list[RecordedInput]) -> None:
    with input_log(folder) as append:
        for one in given_inputs:
            append(one)


@given(st.lists(inputs))
def test_what_is_written_is_read_again(
    tmp_path_factory: pytest.TempPathFactory, given_inputs: list[RecordedInput]
) -> None:
    folder = tmp_path_factory.mktemp("inputs")
    write(folder, given_inputs)
    assert list(read_inputs(folder)) == given_inputs


def test_a_log_cut_anywhere_holds_all_that_was_whole(tmp_path: Path) -> None:
    whole: list[RecordedInput] = [
        MessageInput(stamp_ns=number, topic="/odom", size_bytes=8, payload=bytes([number] * 8))
        for number in range(5)
    ]
    write(tmp_path, whole)
    content = (tmp_path / INPUTS_FILE).read_bytes()
    for length in range(len(content)):
        (tmp_path / INPUTS_FILE).write_bytes(content[:length])
        notices: list[str] = []
        lines = content[:length].count(b"\n")
        assert list(read_inputs(tmp_path, notices.append)) == whole[:lines]
        is_whole = content[:length].endswith(b"\n") or length == 0
        place = f"{tmp_path / INPUTS_FILE}:{lines + 1}: cut off"
        assert [notice.split(",")[0] for notice in notices] == ([] if is_whole else [place])


@pytest.mark.parametrize(
    "line", ["", "[]", "{}", '{"event": "dance"}', '{"event": "wake"}', "[" * 100_000, "\xff"]
)
def test_a_line_that_is_no_input_is_named(tmp_path: Path, line: str) -> None:
    write(tmp_path, [WakeInput(stamp_ns=1)])
    with (tmp_path / INPUTS_FILE).open("ab") as file:
        file.write(line.encode("latin-1") + b"\n")
    with pytest.raises(RecordingError, match=r"inputs\.jsonl:2: error: not a recorded input"):
        list(read_inputs(tmp_path))


def test_a_log_is_never_written_over(tmp_path: Path) -> None:
    write(tmp_path, [WakeInput(stamp_ns=1)])
    with pytest.raises(OutputFileError, match="exists already"):
        write(tmp_path, [])
    assert list(read_inputs(tmp_path)) == [WakeInput(stamp_ns=1)]
