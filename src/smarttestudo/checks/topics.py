# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of topics: their properties, their companions, the profile and the recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, partial

from smarttestudo.checks import wording
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.property_doubt import doubt_about, found_in
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.wording import close_topic, new_default, write_topic
from smarttestudo.domain.finding import ProfileFix, Severity, Span
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.parser.cursor import did_you_mean, edit_distance
from smarttestudo.language.resolved_rules import ResolvedRate
from smarttestudo.pacing.coded_video import IMAGE_TYPES

MAX_COMPARED = 256
"""Letters of a topic whose name is compared with others."""
_START = Span(line=1, column=1, end_line=1, end_column=1)
_CAMERA_INFO = "/camera_info"


@lint_rule("unknown-property", Severity.WARNING)
def unknown_property(rules: RuleModel) -> Iterator[Found]:
    """A check, or a rate by a margin, reads a property that the topic's type does not have.

    The rate stays the higher one. The check stays unknown: its block never decides, and as long as it is in
    doubt the topic gets the higher of the rates. Types come from the profile or a recording; without those, a
    topic called `/odom`, `/scan`, `/imu` and the like counts as the type that it usually has, in any
    namespace, and of other topics a name without a dot gives the finding if no common type has it. `msg.`
    before a field of a type of your own settles it.
    """
    doubt_of = cache(partial(doubt_about, context=rules.context))
    for check in (*rules.checks, *rules.disabled_checks):
        doubt = doubt_of(Signal(check.signal.topic, check.syntax.property))
        if doubt is not None:
            yield found_in(check.path, check.syntax.property_span, doubt)
    # A pattern sets several topics by one margin.
    by_margin = {(rate.path, rate.span): rate for rates in rules.settings.values() for rate in rates}
    for rate in by_margin.values():
        doubt = None if rate.margin is None else doubt_of(rate.margin)
        if doubt is not None and rate.statement.margin is not None:
            yield found_in(rate.path, rate.statement.margin.property_span, doubt)


@lint_rule("nothing-relayed", Severity.WARNING, needs_all_statements=True)
def nothing_relayed(rules: RuleModel) -> Iterator[Found]:
    """Nothing that counts sets a rate or records, so that no topic is relayed.

    With such rules an operator sees nothing of the robot: a file of which the most was removed or
    switched off, as it may be while somebody edits it, is pushed and loaded like any other.
    """
    first = next(iter(rules.default_places), None)
    if first is not None and not (rules.relayed or rules.recordings or rules.patterns):
        yield Found(
            path=first,
            span=_START,
            message="nothing is relayed: no rate is set that counts",
            hint="set one, as in SetFrequency /odom 10",
        )


@lint_rule("tf-without-tf-static", Severity.INFO, needs_all_statements=True)
def tf_without_tf_static(rules: RuleModel) -> Iterator[Found]:
    """/tf is relayed and /tf_static is not.

    The fixed frames, for instance from the base to the LiDAR, travel on /tf_static only. Without them the
    operator's RViz cannot place the scan. They cost one message for each new subscriber.
    """
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


@lint_rule("camera-info-off-grid", Severity.INFO, needs_all_statements=True)
def camera_info_off_grid(rules: RuleModel) -> Iterator[Found]:
    """A camera_info has a different rate than its image.

    RViz and image_proc pair an image with the camera_info of exactly the same stamp. Paced separately,
    they rarely have the same stamp, and no image is shown. paced_with lets the camera_info pass with its
    image.
    """
    for info in rules.relayed:
        if info.endswith(_CAMERA_INFO) and rules.context.topic(info).paced_with is None:
            images = [topic for topic in rules.relayed if _is_image_of(info, topic, rules)]
            yield from _first_difference(info, images, rules)


def _is_image_of(info: str, topic: str, rules: RuleModel) -> bool:
    camera = info.removesuffix(_CAMERA_INFO)
    if not topic.startswith(f"{camera}/") or topic == info:
        return False
    name = topic.removeprefix(f"{camera}/")
    return rules.context.type_of(topic) in IMAGE_TYPES or name.startswith("image")


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
    if setting is None:
        return Rate.full()
    return None if setting.margin is not None else setting.rate


def _off_grid(info: str, image: str, rates: tuple[Rate | None, Rate | None], here: ResolvedRate) -> Found:
    return Found(
        path=here.path,
        span=here.span,
        message=f"{info} is relayed at {rates[0]} and {image} at {rates[1]}: their stamps will not match",
        hint=f'set paced_with = "{image}" for {info} in the profile',
        profile_fix=ProfileFix(topic=info, key="paced_with", value=image, title=f"pace {info} with {image}"),
    )


@lint_rule("unnamed-in-profile", Severity.INFO, needs_all_statements=True)
def unnamed_in_profile(rules: RuleModel) -> Iterator[Found]:
    """A topic is in the profile and in no rule file.

    Only topics of a SetFrequency or KeepAtLeast are relayed. The operator does not see this one at all.
    """
    profile = rules.context.profile
    if profile is None:
        return
    unnamed = [topic for topic in profile.topics if topic not in rules.mentions.keys() | rules.relayed.keys()]
    if unnamed:
        yield Found(
            path=profile.path,
            span=_START,
            message=f"no rule names {wording.listed(unnamed)}, which the profile holds",
            hint="only topics of a SetFrequency or KeepAtLeast are relayed",
        )


@lint_rule("not-measured", Severity.INFO, needs_all_statements=True)
def not_measured(rules: RuleModel) -> Iterator[Found]:
    """The profile has the size and rate of a relayed topic from a preset.

    Yours may be several times as large or as fast, and then what fits the budget here does not fit your link.
    The mark is `measured = false` in the topic's table.
    """
    profile = rules.context.profile
    if profile is None:
        return
    guessed = [name for name, topic in profile.topics.items() if not topic.measured and name in rules.relayed]
    if guessed:
        yield Found(
            path=profile.path,
            span=_START,
            message=f"the profile has {wording.listed(guessed)} from a preset, not measured",
            hint="measure them: testudo profile --bag or --seconds, or Measure on the Ruler's page",
        )


@lint_rule("absent-from-bag", Severity.INFO)
def absent_from_bag(rules: RuleModel) -> Iterator[Found]:
    """A rule names a topic that the recording of --bag, or the robot of --connect, does not have.

    Usually the name is misspelt. Without such a topic nothing is relayed, and checks of it stay unknown.
    """
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


@lint_rule("absent-from-profile", Severity.INFO)
def absent_from_profile(rules: RuleModel) -> Iterator[Found]:
    """A rule names a topic that is one letter off a topic of the profile.

    Usually the name is misspelt. Without such a topic nothing is relayed, and checks of it stay unknown.
    """
    profile = rules.context.profile
    if profile is None or rules.context.bag_topics is not None:
        # What a recording has says more.
        return
    recorded = {topic for recording in rules.recordings for topic in recording.topics}
    for topic, mention in rules.mentions.items():
        if topic not in profile.topics and topic not in recorded:
            close = next((known for known in profile.topics if _is_one_letter_off(topic, known)), None)
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


@lint_rule("unnamed-in-bag", Severity.INFO, needs_all_statements=True)
def unnamed_in_bag(rules: RuleModel) -> Iterator[Found]:
    """The recording given with --bag, or the robot given with --connect, has a topic that no rule names.

    Only topics of a SetFrequency or KeepAtLeast are relayed. The operator does not see this one at all.
    """
    recorded, profile = rules.context.bag_topics, rules.context.profile
    first = next(iter(rules.default_places), None)
    if recorded is None or first is None:
        return
    meant = (close_topic(topic, recorded) for topic in rules.mentions if topic not in recorded)
    known = {*rules.mentions, *rules.relayed, *(profile.topics if profile else ()), *_OF_ROS, *meant}
    unnamed = sorted(topic for topic in recorded if topic not in known)
    if unnamed:
        yield Found(
            path=first,
            span=_START,
            message=f"no rule names {wording.listed(unnamed)}, {rules.context.topics_have}",
            hint="only topics of a SetFrequency or KeepAtLeast are relayed",
        )
