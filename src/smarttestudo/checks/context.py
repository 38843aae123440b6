# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The knowledge of the checker beside the rule files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from smarttestudo.domain.names import is_source, resolve_topic
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.signal import ArrivalProperty, Signal, SignalKind
from smarttestudo.language.known_types import NO_TYPES, KnownTypes
from smarttestudo.language.normal_form import Resolve, derived_values, is_derived
from smarttestudo.language.properties import PropertySpec, conventional_types, property_spec
from smarttestudo.language.region import Region
from smarttestudo.language.text_region import SetOfValues, TextRegion

COMMAND_TYPES = frozenset({"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"})
"""Types whose numbers are commanded, so that they can be exactly 0."""


def values_of(spec: PropertySpec | None) -> Region:
    """The values that a property can have."""
    if spec is None:
        return Region.everything()
    return Region.between(spec.minimum, spec.maximum, includes_minimum=spec.includes_minimum)


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedValues:
    """Values of a property in a recording: the ``greatest``, ``None`` where there was none, and why.

    ``texts`` are those of one that is a text, at most a few. ``close`` is a property that may be meant.
    """

    greatest: float | None = None
    texts: tuple[str, ...] = ()
    why: str = ""
    close: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckContext:
    """``resolve`` gives the full name of a topic, ``bag_topics`` the type of each topic of a recording.

    ``types`` are the topics that patterns match, and what is known of types.
    They may also be those of a robot: ``topics_lack`` are the words before the name of a topic that it lacks,
    ``topics_have`` those behind what it has. ``observed`` are the values that the recording has of checks.
    ``way_to_profile`` says how the reader of a finding gives a profile, as in "or …".
    ``has_all_files`` is false where a file of the set could not be read, so that statements are missing.
    """

    resolve: Resolve = field(default=resolve_topic)
    profile: Profile | None = None
    bag_topics: Mapping[str, str] | None = None
    types: KnownTypes = NO_TYPES
    topics_lack: str = "the recording has no"
    topics_have: str = "which the recording holds"
    observed: Mapping[Signal, ObservedValues] = field(default_factory=dict)
    has_all_files: bool = True
    way_to_profile: str = "give a profile with --profile"

    def topic(self, topic: str) -> TopicProfile:
        """The profile's entry of ``topic``, an empty one without a profile."""
        return TopicProfile() if self.profile is None else self.profile.topic(topic)

    def known_type(self, topic: str) -> str | None:
        """The ROS type of ``topic``: the profile's word, else the recording's; vitals are their own."""
        if is_source(topic):
            return topic
        return self.topic(topic).type_name or (self.bag_topics or {}).get(topic)

    def type_of(self, topic: str) -> str | None:
        """The known type of ``topic``, else the one that a topic of its name usually has."""
        return self.known_type(topic) or next(iter(conventional_types(topic)), None)

    def spec_of(self, signal: Signal) -> PropertySpec | None:
        """The description of a property; ``None`` for a plain field."""
        return property_spec(self.type_of(signal.topic), signal.property)

    def domain(self, signal: Signal) -> SetOfValues:
        """The values that ``signal`` can have."""
        if is_derived(signal):
            return derived_values(signal)
        return TextRegion.everything() if signal.kind is SignalKind.TEXT else values_of(self.spec_of(signal))

    def is_measured(self, signal: Signal) -> bool:
        """Whether ``signal`` is known to be a measurement, which varies continuously and has noise."""
        spec = self.spec_of(signal)
        # What has no unit is a state, and no measurement.
        return spec is not None and bool(spec.unit) and self.type_of(signal.topic) not in COMMAND_TYPES

    def is_noisy(self, signal: Signal) -> bool:
        """Whether ``signal`` can go back and forth across a border while the robot hardly moves."""
        return (
            not is_derived(signal)
            and self.is_measured(signal)
            and signal.property != ArrivalProperty.AGE.value
        )
