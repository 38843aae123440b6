# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A status survives the way to another process, and nonsense does not get through."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.status import RulesOrigin
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


def test_a_status_of_an_older_version_is_read() -> None:
    newer = {"status_hz", "blocks"}
    older = {name: value for name, value in RECORD.items() if name not in newer}
    older["rules"] = {name: RECORD["rules"][name] for name in ("files", "sha256")}
    status = status_from_text(json.dumps(older))
    assert (status.status_hz, status.blocks, status.rules.origin) == (1.0, (), RulesOrigin.FILES)
    assert status.topics == STATUS.topics


def test_what_a_newer_version_adds_is_left_out() -> None:
    newer = {**RECORD, "mood": "good", "rules": {**RECORD["rules"], "origin": "elsewhere", "mood": 1}}
    newer["blocks"] = [{"file": 0, "state": "maybe"}, None, *RECORD["blocks"]]
    status = status_from_text(json.dumps(newer))
    assert (status.blocks, status.rules.origin) == (STATUS.blocks, RulesOrigin.FILES)


@given(value=json_values)
def test_a_block_with_anything_in_it_is_read_or_left_out(value: object) -> None:
    for name in ("file", "line", "state", "checks"):
        block = {**RECORD["blocks"][0], name: value}
        status_from_text(json.dumps({**RECORD, "blocks": [block]}))
    status_from_text(
        json.dumps({**RECORD, "blocks": [{**RECORD["blocks"][0], "checks": [[1, 2, "true", value]]}]})
    )


def test_what_conditions_add_to_a_status_is_small() -> None:
    blocks = json.dumps(RECORD["blocks"][0])
    assert len(blocks) < 150


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
