# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Publishers that come, leave or are replaced are found, also those of which nobody was told."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from robot.small_graph import TEXT
from smarttestudo.domain.robot import Endpoint, GraphChange
from smarttestudo.robot.topics import POLLS_PER_ROUND, QUIET_POLLS_PER_ROUND, EndpointCache


def published_by(gid: bytes) -> Endpoint:
    return Endpoint(node="/driver", type_name=TEXT, reliable=True, transient_local=False, gid=gid)


@given(change=st.sampled_from(("comes", "leaves", "is replaced")), topics=st.integers(1, 60))
def test_where_changes_are_told_one_that_was_not_is_found_all_the_same(change: str, topics: int) -> None:
    names = [f"/t{number}" for number in range(topics)]
    there = {name: [published_by(b"first")] for name in names}
    calls = {"count": 0, "find": 0}

    def count(name: str) -> int:
        calls["count"] += 1
        return len(there[name])

    def find(name: str) -> list[Endpoint]:
        calls["find"] += 1
        return list(there[name])

    cache = EndpointCache(count, find)
    assert cache.poll(names, GraphChange.NONE) == names
    calls.update(count=0, find=0)
    first, second = published_by(b"first"), published_by(b"second")
    there[names[-1]] = {"comes": [first, second], "leaves": [], "is replaced": [second]}[change]
    looks = QUIET_POLLS_PER_ROUND * (1 if change != "is replaced" else POLLS_PER_ROUND)
    found = [cache.poll(names, GraphChange.NONE) for _ in range(looks)]
    assert [topic for look in found for topic in look] == names[-1:]
    assert calls["count"] + calls["find"] <= looks * (topics // QUIET_POLLS_PER_ROUND + 1) + 1
    assert cache.of(names[-1]) == there[names[-1]]
