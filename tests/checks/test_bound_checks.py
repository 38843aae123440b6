# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said of topics that are bound: alone, in rules only, and in doubt."""

from __future__ import annotations

import pytest

from checks.rule_findings import codes_of, covered, findings_of
from smarttestudo.checks import CheckContext
from smarttestudo.domain.profile import Profile, TopicProfile

BLOCK = "If CheckValue /battery_state level < 20 Then KeepWithin /odom position 0.05 EndIf"


def test_a_bound_alone_relays_its_topic_and_nothing_is_wrong_with_it() -> None:
    assert codes_of("begin KeepWithin /odom position 0.05 end") == []
    assert codes_of("begin KeepWithin /tf position 0.05 end") == ["tf-without-tf-static"]


def test_a_topic_that_only_rules_name_is_said_to_be_full_elsewhere_and_what_that_costs() -> None:
    entry = TopicProfile(message_kb=0.72, source_hz=25)
    context = CheckContext(profile=Profile(topics={"/odom": entry}))
    (finding,) = findings_of(f"begin {BLOCK} end", context=context)
    assert (finding.code, finding.message) == (
        "missing-default",
        "/odom has no default: it is Full (18.0 KB/s) where no block bounds it and while values are unknown",
    )


@pytest.mark.parametrize(
    ("rate", "passes"), [("10", "what its rate lets through"), ("Full", "every message")]
)
def test_a_bound_in_rules_only_is_said_not_to_hold_in_doubt(rate: str, passes: str) -> None:
    text = f"begin SetFrequency /odom {rate} {BLOCK} end"
    (finding,) = findings_of(text)
    assert (finding.code, finding.message) == (
        "bound-in-rules-only",
        f"only rules bound /odom: while none of them is known to hold, also in doubt, {passes} passes",
    )
    assert covered(text, finding.span) == "KeepWithin /odom position 0.05"


@pytest.mark.parametrize("default", ["KeepWithin /odom orientation 5", "SetFrequency /odom Off"])
def test_nothing_is_said_where_a_bound_always_holds_or_nothing_passes(default: str) -> None:
    assert "bound-in-rules-only" not in codes_of(f"begin {default} {BLOCK} end")
