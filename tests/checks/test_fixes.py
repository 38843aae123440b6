# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a click on a finding changes in the text."""

from __future__ import annotations

import pytest

from checks.rule_findings import applied, findings_of
from smarttestudo.checks import CheckContext
from smarttestudo.domain.finding import Finding
from smarttestudo.domain.profile import Profile, TopicProfile

RULE = """\
    // Only there
    Rule "Dock"
    If CheckValue /odom pose_x > 5 Then
        SetFrequency /scan 3
    EndIf
"""


@pytest.mark.parametrize(
    ("text", "mended"),
    [
        pytest.param(
            f"begin\n    SetFrequency /odom 4  // the map\n\n{RULE}end\n",
            f"begin\n    SetFrequency /odom 4  // the map\n    SetFrequency /scan 1\n\n{RULE}end\n",
            id="behind the last default, whose comment stays with it",
        ),
        pytest.param(
            f"// Rules\nbegin  // of the dock\n{RULE}end\n",
            f"// Rules\nbegin  // of the dock\n    SetFrequency /scan 1\n{RULE}end\n",
            id="before the first rule and its comment",
        ),
        pytest.param(
            "begin SetFrequency /odom 4 If CheckValue /odom pose_x > 5 Then SetFrequency /scan 3 end",
            "begin SetFrequency /odom 4 SetFrequency /scan 1"
            " If CheckValue /odom pose_x > 5 Then SetFrequency /scan 3 end",
            id="on the one line that there is",
        ),
        pytest.param(
            "begin If CheckValue /odom pose_x > 5 Then SetFrequency /scan 3 end",
            "begin SetFrequency /scan 1 If CheckValue /odom pose_x > 5 Then SetFrequency /scan 3 end",
            id="before the one rule on the one line",
        ),
        pytest.param(
            f"begin\n    KeepAtLeast /odom 1\nend\nbegin\n{RULE}end\n",
            f"begin\n    KeepAtLeast /odom 1\n    SetFrequency /scan 1\nend\nbegin\n{RULE}end\n",
            id="in the collection with defaults",
        ),
    ],
)
def test_a_default_is_added_where_defaults_stand(text: str, mended: str) -> None:
    finding = _finding(text, "missing-default")
    assert finding.fix is not None
    assert finding.fix.title == "add SetFrequency /scan 1"
    assert applied(text, finding) == mended
    assert "missing-default" not in {one.code for one in findings_of(mended)}


def test_the_looser_of_two_bounds_goes() -> None:
    text = "begin SetFrequency /odom Full KeepWithin /odom position {} KeepWithin /odom position {} end"
    for first, second, kept in (("0.05", "0.1", "0.05"), ("0.1", "0.05", "0.05")):
        written = text.format(first, second)
        mended = applied(written, _finding(written, "bound-twice"))
        assert mended.count("KeepWithin") == 1
        assert f"position {kept}" in mended


def test_a_duration_becomes_the_shortest_that_a_message_can_show() -> None:
    text = "begin SetFrequency /odom 5 If CheckValue /odom speed > 1 For 1 ms Then SetFrequency /odom 9 end"
    context = CheckContext(profile=Profile(topics={"/odom": TopicProfile(source_hz=30)}))
    (finding,) = findings_of(text, context=context)
    mended = applied(text, finding)
    assert "For 34 ms" in mended
    assert findings_of(mended, context=context) == []


def test_a_misspelt_topic_is_written_as_it_is_published() -> None:
    text = "begin SetFrequency /joint_state 3 end"
    (finding,) = findings_of(text, context=CheckContext(bag_topics={"/joint_states": "x/msg/Y"}))
    assert applied(text, finding) == "begin SetFrequency /joint_states 3 end"


def test_what_only_the_profile_can_mend_says_the_entry() -> None:
    text = "begin SetFrequency /camera/image_raw 10 SetFrequency /camera/camera_info 3 end"
    fix = _finding(text, "camera-info-off-grid").profile_fix
    assert fix is not None
    assert (fix.topic, fix.key, fix.value) == ("/camera/camera_info", "paced_with", "/camera/image_raw")


def _finding(text: str, code: str) -> Finding:
    return next(one for one in findings_of(text) if one.code == code)
