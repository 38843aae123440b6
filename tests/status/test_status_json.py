# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A status survives the way to another process, and nonsense does not get through."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.status_json import status_from_text, status_to_json
from status.statuses import STATUS

TEXT = json.dumps(status_to_json(STATUS))
RECORD = json.loads(TEXT)
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


def test_what_is_written_is_read() -> None:
    assert status_from_text(TEXT) == STATUS


def test_topics_are_by_name_and_full_is_null_as_in_decisions() -> None:
    assert RECORD["topics"]["/estop"]["target_hz"] is None
    assert RECORD["topics"]["/cmd_vel"]["target_hz"] == 0
    assert RECORD["topics"]["/cmd_vel"]["silent"] == "Off"
    assert RECORD["topics"]["/imu"]["dropped"] == 1450
    assert RECORD["out_kb_per_s"] == 946


@pytest.mark.parametrize("text", ["", "[]", "{}", "null", "[" * 100_000, '{"node": 1e999}', TEXT[:-5]])
def test_what_is_no_status_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        status_from_text(text)


@given(name=st.sampled_from(sorted(RECORD)), value=json_values)
def test_a_status_with_any_entry_changed_is_read_or_refused(name: str, value: object) -> None:
    try:
        status_from_text(json.dumps({**RECORD, name: value}))
    except ValueError:
        return


@given(name=st.sampled_from(sorted(RECORD["topics"]["/imu"])), value=json_values)
def test_a_topic_with_any_entry_changed_is_read_or_refused(name: str, value: object) -> None:
    try:
        status_from_text(
            json.dumps({**RECORD, "topics": {"/imu": {**RECORD["topics"]["/imu"], name: value}}})
        )
    except ValueError:
        return
