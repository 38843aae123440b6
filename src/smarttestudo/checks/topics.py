# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks of topics: their properties, their companions, the profile and the recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, partial

from smarttestudo.checks import wording
from smarttestudo.checks.fixes import close_topic, new_default, write_topic
from smarttestudo.checks.property_doubt import doubt_about, found_in
from smarttestudo.checks.rule_check import Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import ProfileFix, Severity, Span
from smarttestudo.domain.rate import Rate
from smarttestudo.language.parser.suggestions import did_you_mean, edit_distance
from smarttestudo.language.resolved_rules import ResolvedRate

MAX_COMPARED = 256
"""Letters of a topic whose name is compared with others."""
_START = Span(line=1, column=1, end_line=1, end_column=1)
_CAMERA_INFO = "/camera_info"
_IMAGE_TYPES = frozenset({"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"})


def _unknown_property(rules: RuleModel) -> Iterator[Found]:
    """Properties that a topic's type does not have."""
    doubt_of = cache(partial(doubt_about, context=rules.context))
    for one in (*rules.checks, *rules.disabled_checks):
        doubt = doubt_of(one.signal)
        if doubt is not None:
            yield found_in(one.path, one.check.property_span, doubt)


def _nothing_relayed(rules: RuleModel) -> Iterator[Found]:
    """Files in which nothing that counts names a topic to relay, or records."""
    first = next(iter(rules.default_places), None)
    if first is not None and not rules.relayed and not rules.recordings:
        yield Found(
            path=first,
            span=_START,
            message="nothing is relayed: no rate is set that counts",
            hint="set one, as in SetFrequency /odom 10",
        )


def _tf_without_tf_static(rules: RuleModel) -> Iterator[Found]:
    """/tf without /tf_static."""
    for topic, first in rules.relayed.items():
        if topic.endswith("/tf") and f"{topic}_static" not in rules.relayed:
            static = f"{first.statement.topic.text}_static"
            yield Found(
                path=first.path,
                span=first.statement.topic.span,
                message=f"{topic} is relayed without {topic}_static",
                hint=f"add SetFrequency {static} Full",
                fix=new_default(rules.default_places.get(first.path), static),
            )


def _camera_info_off_grid(rules: RuleModel) -> Iterator[Found]:
    """camera_info at another rate than its image."""
    for info in rules.relayed:
        if info.endswith(_CAMERA_INFO) and rules.context.topic(info).paced_with is None:
            images = [topic for topic in rules.relayed if _is_image_of(info, topic, rules)]
            yield from _first_difference(info, images, rules)


def _is_image_of(info: str, topic: str, rules: RuleModel) -> bool:
    camera = info.removesuffix(_CAMERA_INFO)
    if not topic.startswith(f"{camera}/") or topic == info:
        return False
    name = topic.removeprefix(f"{camera}/")
    return rules.context.type_of(topic) in _IMAGE_TYPES or name.startswith("image")


def _first_difference(info: str, images: list[str], rules: RuleModel) -> Iterator[Found]:
    for settings in ({}, *(branch.settings for branch in rules.branches)):
        for image in images:
            here = _statement(image, settings, rules) or _statement(info, settings, rules)
            rates = _rate(info, settings, rules), _rate(image, settings, rules)
            if here is not None and None not in rates and rates[0] != rates[1]:
                yield _off_grid(info, image, rates, here)
                return


def _statement(topic: str, settings: Mapping[str, ResolvedRate], rules: RuleModel) -> ResolvedRate | None:
    return settings.get(topic) if settings else rules.defaults.get(topic)


def _rate(topic: str, settings: Mapping[str, ResolvedRate], rules: RuleModel) -> Rate | None:
    setting = settings.get(topic) or rules.defaults.get(topic)
    return Rate.full() if setting is None else setting.rate


def _off_grid(info: str, image: str, rates: tuple[Rate | None, Rate | None], here: ResolvedRate) -> Found:
    return Found(
        path=here.path,
        span=here.span,
        message=f"{info} is relayed at {rates[0]} and {image} at {rates[1]}: their stamps will not match",
        hint=f'set paced_with = "{image}" for {info} in the profile',
        profile_fix=ProfileFix(topic=info, key="paced_with", value=image, title=f"pace {info} with {image}"),
    )


def _unnamed_in_profile(rules: RuleModel) -> Iterator[Found]:
    """Topics of the profile that no rule names."""
    profile = rules.context.profile
    if profile is None:
        return
    unnamed = [topic for topic in profile.topics if topic not in rules.mentions]
    if unnamed:
        yield Found(
            path=profile.path,
            span=_START,
            message=f"no rule names {wording.listed(unnamed)}, which the profile holds",
            hint="only topics of a SetFrequency or KeepAtLeast are relayed",
        )


def _absent_from_bag(rules: RuleModel) -> Iterator[Found]:
    """Topics that a recording does not hold, or a robot does not publish."""
    recorded = rules.context.bag_topics
    if recorded is None:
        return
    unpublished = "a topic that never publishes is never relayed, and its values stay unknown"
    for topic, mention in rules.mentions.items():
        if topic not in recorded:
            close = close_topic(topic, recorded)
            yield Found(
                path=mention.path,
                span=mention.name.span,
                message=f"{rules.context.topics_lack} {topic}",
                hint=did_you_mean(close) if close else unpublished,
                fix=write_topic(mention.name, close),
            )


def _absent_from_profile(rules: RuleModel) -> Iterator[Found]:
    """Topics that the profile has under a name one letter off."""
    profile = rules.context.profile
    if profile is None or rules.context.bag_topics is not None:
        # What a recording has says more.
        return
    recorded = {topic for one in rules.recordings for topic in one.topics}
    for topic, mention in rules.mentions.items():
        if topic not in profile.topics and topic not in recorded:
            close = next((one for one in profile.topics if _is_one_letter_off(topic, one)), None)
            if close is not None:
                yield Found(
                    path=mention.path,
                    span=mention.name.span,
                    message=f"the profile has no {topic}",
                    hint=did_you_mean(close),
                    fix=write_topic(mention.name, close),
                )


def _is_one_letter_off(topic: str, known: str) -> bool:
    """Whether one letter is missing, too many, another one or swapped; numbers tell topics apart."""
    if abs(len(topic) - len(known)) > 1 or len(topic) > MAX_COMPARED:
        return False
    return _without_digits(topic) != _without_digits(known) and edit_distance(topic, known) == 1


def _without_digits(topic: str) -> str:
    return "".join(letter for letter in topic if not letter.isdigit())


_OF_ROS = frozenset({"/rosout", "/parameter_events", "/clock", "/events/write_split"})


def _unnamed_in_bag(rules: RuleModel) -> Iterator[Found]:
    """Topics of a recording, or of a robot, that no rule names."""
    recorded, profile = rules.context.bag_topics, rules.context.profile
    first = next(iter(rules.default_places), None)
    if recorded is None or first is None:
        return
    meant = (close_topic(topic, recorded) for topic in rules.mentions if topic not in recorded)
    told = {*rules.mentions, *(profile.topics if profile else ()), *_OF_ROS, *meant}
    unnamed = sorted(topic for topic in recorded if topic not in told)
    if unnamed:
        yield Found(
            path=first,
            span=_START,
            message=f"no rule names {wording.listed(unnamed)}, {rules.context.topics_have}",
            hint="only topics of a SetFrequency or KeepAtLeast are relayed",
        )


CHECKS = (
    RuleCheck(code="unknown-property", severity=Severity.WARNING, find=_unknown_property),
    RuleCheck(
        code="nothing-relayed",
        severity=Severity.WARNING,
        find=_nothing_relayed,
        needs_all_statements=True,
    ),
    RuleCheck(
        code="tf-without-tf-static",
        severity=Severity.INFO,
        find=_tf_without_tf_static,
        needs_all_statements=True,
    ),
    RuleCheck(
        code="camera-info-off-grid",
        severity=Severity.INFO,
        find=_camera_info_off_grid,
        needs_all_statements=True,
    ),
    RuleCheck(
        code="unnamed-in-profile", severity=Severity.INFO, find=_unnamed_in_profile, needs_all_statements=True
    ),
    RuleCheck(code="absent-from-bag", severity=Severity.INFO, find=_absent_from_bag),
    RuleCheck(code="absent-from-profile", severity=Severity.INFO, find=_absent_from_profile),
    RuleCheck(code="unnamed-in-bag", severity=Severity.INFO, find=_unnamed_in_bag, needs_all_statements=True),
)
