# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of a live run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import starmap
from pathlib import Path

from smarttestudo.domain.profile import Profile
from smarttestudo.domain.remote_robots import RuleText, RuleTexts
from smarttestudo.domain.status import RulesInForce
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.rules.rule_sets import check_texts

LARGE_BYTES = 64_000
"""How large rule texts may be to be checked while messages wait: that takes a few tenths of a second."""


def are_large(texts: Mapping[str, str]) -> bool:
    """Whether rule texts by path are larger than ``LARGE_BYTES``, where each character takes one byte."""
    return sum(map(len, texts.values())) > LARGE_BYTES


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveRules:
    """Valid rules: their meaning, and their texts by path.

    ``doubts`` has the first warning of a check, empty without any.
    ``output_topics`` has the output topic of each relayed one, ``names`` the full name of each topic by the
    name that the texts use, ``known`` what they were compiled by of what the robot has.
    """

    rule_set: RuleSet
    output_topics: Mapping[str, str] = field(default_factory=dict)
    profile: Profile = field(default_factory=Profile)
    in_force: RulesInForce = field(default_factory=RulesInForce)
    texts: Mapping[str, str] = field(default_factory=dict)
    profile_text: str | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    known: KnownTypes = field(default_factory=KnownTypes)
    doubts: str = ""

    @property
    def rules_hash(self) -> str:
        """The SHA-256 of the rule texts, one after the other; empty while there are none."""
        return self.in_force.sha256

    @property
    def is_large(self) -> bool:
        """Whether what is made of them takes so long that messages would wait."""
        return are_large(self.texts)

    @property
    def rule_texts(self) -> RuleTexts:
        """The texts of the rules in force, for the node's parameter."""
        renamed = {name: full for name, full in self.names.items() if name != full}
        return RuleTexts(
            sha256=self.rules_hash, files=tuple(starmap(RuleText, self.texts.items())), full_names=renamed
        )


def check_live_rules(
    texts: Mapping[str, str],
    profile_path: Path | None,
    profile_text: str | None,
    resolve: Resolve,
    known: KnownTypes | None = None,
) -> LiveRules:
    """The rules of ``texts`` by path beside the profile at ``profile_path``; their outputs have no names yet.

    ``resolve`` gives the full name of a topic. They are compiled by what is ``known`` of the robot, and
    judged without: rules are not refused for what happens to run. Raises ``TestudoError``.
    """
    names: dict[str, str] = {}

    def named(topic: str) -> str:
        if topic not in names:
            names[topic] = resolve(topic)
        return names[topic]

    profile = None
    if profile_path is not None and profile_text is not None:
        from smarttestudo.rules.profile_file import parse_profile  # noqa: PLC0415  it reads TOML

        profile = parse_profile(profile_text, profile_path).resolved(named)
    loaded = check_texts(texts, profile=profile, resolve=named)
    loaded.refuse_errors()
    return LiveRules(
        rule_set=loaded.rule_set.by(known or KnownTypes()),
        known=known or KnownTypes(),
        profile=profile or Profile(),
        in_force=loaded.in_force,
        texts=texts,
        profile_text=profile_text,
        names=names,
        doubts=loaded.doubts,
    )
