# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates of topics whose messages need each other are findings, wherever the type is known from."""

from __future__ import annotations

import pytest

from checks.rule_findings import applied, codes_of, findings_of
from smarttestudo.checks import CheckContext
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.profile import Profile, TopicProfile

VIDEO = ("foxglove_msgs/msg/CompressedVideo", "ffmpeg_image_transport_msgs/msg/FFMPEGPacket")
PATCHES = (
    "map_msgs/msg/OccupancyGridUpdate",
    "map_msgs/msg/PointCloud2Update",
    "nav2_msgs/msg/CostmapUpdate",
    "visualization_msgs/msg/InteractiveMarkerUpdate",
    "moveit_msgs/msg/PlanningScene",
)
RULES = "begin SetFrequency {} 2 end"


def known(type_name: str, topic: str = "/t", source_hz: float | None = None) -> list[CheckContext]:
    profile = Profile(topics={topic: TopicProfile(type_name=type_name, source_hz=source_hz)})
    recorded = CheckContext(bag_topics={topic: type_name})
    return [CheckContext(profile=profile)] if source_hz else [CheckContext(profile=profile), recorded]


@pytest.mark.parametrize("type_name", [*VIDEO, *(name.replace("/msg/", "/") for name in VIDEO)])
def test_coded_video_at_a_rate_is_told(type_name: str) -> None:
    for context in known(type_name):
        (finding,) = findings_of(RULES.format("/t"), context=context)
        assert (finding.code, finding.severity) == ("video-in-groups", Severity.INFO)
        assert "at 2 Hz it shows only the beginning of each group" in finding.message


@pytest.mark.parametrize(("source_hz", "share"), [(2.5, "80 %"), (8, "25 %"), (30, "7 %")])
def test_with_its_source_the_finding_says_how_much_is_shown(source_hz: float, share: float) -> None:
    (finding,) = findings_of(RULES.format("/t"), context=known(VIDEO[0], source_hz=source_hz)[0])
    assert f"at 2 of {source_hz:g} Hz it shows the first {share} of each group" in finding.message


@pytest.mark.parametrize("topic", ["/camera/h264", "/camera/image_raw/ffmpeg_h265", "/AV1", "/front/hevc"])
def test_a_compressed_image_is_video_where_its_transport_says_so(topic: str) -> None:
    for context in known("sensor_msgs/msg/CompressedImage", topic):
        assert codes_of(RULES.format(topic), context=context) == ["video-in-groups"]
    for context in known("sensor_msgs/msg/CompressedImage", "/h264/compressed"):
        assert codes_of(RULES.format("/h264/compressed"), context=context) == []


@pytest.mark.parametrize("type_name", [*PATCHES, *(name.replace("/msg/", "/") for name in PATCHES)])
def test_patches_at_a_rate_are_a_warning_with_a_fix(type_name: str) -> None:
    for context in known(type_name):
        text = RULES.format("/t")
        (finding,) = findings_of(text, context=context)
        assert (finding.code, finding.severity) == ("patches-thinned", Severity.WARNING)
        assert "at 2 Hz some are left out" in finding.message
        assert codes_of(applied(text, finding), context=context) == []


@pytest.mark.parametrize("type_name", [VIDEO[0], PATCHES[0]])
def test_where_all_passes_or_nothing_there_is_none(type_name: str) -> None:
    for context in known(type_name):
        for rate in ("Full", "Off", "0"):
            assert codes_of(f"begin SetFrequency /t {rate} end", context=context) == []
        assert codes_of("begin KeepAtLeast /t 2 end", context=context) == []
    assert codes_of("begin SetFrequency /t 30 end", context=known(type_name, source_hz=30)[0]) == []


@pytest.mark.parametrize("type_name", [VIDEO[0], PATCHES[0]])
def test_of_several_statements_the_first_that_thins_is_told(type_name: str) -> None:
    rules = (
        "begin\nSetFrequency /t Full\nIf CheckValue /b level < 20 Then\nSetFrequency /t 2\nElse\n"
        "SetFrequency /t 5\nEndIf\nend"
    )
    for context in known(type_name):
        found = [one for one in findings_of(rules, context=context) if "absent" not in one.code]
        assert [one.span.line for one in found] == [4]


def test_a_type_that_is_not_known_gives_none() -> None:
    assert codes_of(RULES.format("/camera/h264")) == []
    assert codes_of(RULES.format("/costmap_updates")) == []
