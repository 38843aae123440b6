# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files on disk to one rule set, with rates for their quality levels."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.status import RulesInForce
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RefusedTiers, RuleSet, TierValues, compile_rules
from smarttestudo.language.syntax import (
    RuleFile,
)
from smarttestudo.language.syntax_walks import (
    tiers_in,
)
from smarttestudo.rules.rule_files import find_rule_files, read_rule_text


def has_tiers(files: Sequence[RuleFile]) -> bool:
    """Whether any statement of ``files`` that counts names a quality level."""
    return any(True for file in files for statement in file.enabled_statements for _ in tiers_in(statement))


def tier_values_for(
    files: Sequence[RuleFile], profile: Profile | None, resolve: Resolve, types: KnownTypes
) -> TierValues:
    """The rates and bounds of the levels in ``files``, for ``compile_rules``; all refused without a profile.

    Raises ``RuleFileError`` for what does not fit, ``ProfileError`` for what the profile lacks.
    """
    if profile is None or not has_tiers(files):
        return RefusedTiers()
    from smarttestudo.rules.tier_rates import fitting_tiers  # noqa: PLC0415  most rules name rates, not levels

    return fitting_tiers(files, profile, resolve, types)


class FaultyRulesError(RuleFileError):
    """The first error of ``rules``, which have some."""

    rules: LoadedRules


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedRules:
    """Findings on rule files, and the rules that they form together; ``texts`` are the files by path.

    ``rule_set`` is empty where a finding is an error.
    """

    findings: tuple[Finding, ...]
    rule_set: RuleSet
    texts: Mapping[str, str]

    @property
    def errors(self) -> tuple[Finding, ...]:
        """The findings that stop the files from being used."""
        return tuple(finding for finding in self.findings if finding.severity is Severity.ERROR)

    def refuse_errors(self) -> None:
        """Raise ``FaultyRulesError`` with the first error where there is one."""
        if not self.errors:
            return
        first = self.errors[0]
        error = FaultyRulesError(
            f"{first.message}{_of_how_many(self.errors, 'errors')}",
            place=_place(first),
            remedy=first.hint or None,
        )
        error.rules = self
        raise error

    @property
    def doubts(self) -> str:
        """The first warning in one line, with how many there are; empty without any."""
        warnings = [finding for finding in self.findings if finding.severity is Severity.WARNING]
        if not warnings:
            return ""
        first = warnings[0]
        return f"{_place(first)}: warning: {first.message}{_of_how_many(warnings, 'warnings')}"

    @property
    def in_force(self) -> RulesInForce:
        """The files, and the SHA-256 of their text in UTF-8, one after the other."""
        sha256 = sha256_of_rules("".join(self.texts.values()))
        return RulesInForce(paths=tuple(map(in_utf_8, self.texts)), sha256=sha256)


def _place(finding: Finding) -> str:
    return f"{finding.path}:{finding.span.line}:{finding.span.column}"


def _of_how_many(findings: Sequence[Finding], what: str) -> str:
    return f" (the first of {len(findings)} {what})" if len(findings) > 1 else ""


def sha256_of_rules(text: str) -> str:
    """The SHA-256 by which a status and an incident name the rules with this ``text``."""
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()


def known_types(found: KnownTypes | None, profile: Profile | None) -> KnownTypes:
    """Topics and types that were ``found`` in a recording or on a robot, with the profile's word on types.

    Where nothing was looked at, the topics of the profile are those that are there.
    """
    declared = {} if profile is None else profile.topics
    types = {topic: entry.type_name for topic, entry in declared.items() if entry.type_name}
    if found is None:
        return KnownTypes(topics={topic: types.get(topic, "") for topic in declared}, declared=types)
    return replace(found, declared=types)


def load_rules(
    paths: Sequence[Path], *, profile: Profile | None = None, found: KnownTypes | None = None
) -> LoadedRules:
    """Read, check and compile the rule files at ``paths``, which may be folders; see ``check_texts``.

    Raises:
        RuleFileError: a file cannot be read at all, or its levels do not fit the budget.
        ProfileError: the profile lacks what its levels need.
    """
    texts = {str(path): read_rule_text(path) for path in find_rule_files(paths)}
    return check_texts(texts, profile=profile, found=found)


def check_texts(
    texts: Mapping[str, str],
    *,
    profile: Profile | None = None,
    found: KnownTypes | None = None,
    resolve: Resolve = resolve_topic,
) -> LoadedRules:
    """Check and compile rule files, given by path.

    ``resolve`` gives topics their full names (default: in the root namespace); ``found`` is what a recording
    or a robot has. Quality levels get the rates that the optimizer finds for them in the profile's budget.

    Raises:
        RuleFileError: the levels do not fit the budget.
        ProfileError: the profile lacks what the levels need.
    """
    results = [parse(text, path) for path, text in texts.items()]
    bag_topics = None if found is None else found.topics
    types = known_types(found, profile)
    context = CheckContext(resolve=resolve, profile=profile, bag_topics=bag_topics, types=types)
    findings = tuple(check_rules(results, context))
    has_error = any(finding.severity is Severity.ERROR for finding in findings)
    usable = RuleSource(
        files=() if has_error else tuple(result.file for result in results), profile=profile, resolve=resolve
    )
    return LoadedRules(findings=findings, rule_set=usable.compiled(types), texts=texts)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSource:
    """Rule files without errors, and what gives them a meaning beside the topics that are there."""

    files: tuple[RuleFile, ...]
    profile: Profile | None = None
    resolve: Resolve = resolve_topic

    def __call__(self, found: KnownTypes) -> RuleSet:
        """The rules where that was ``found``. Raises as ``check_texts``."""
        return self.compiled(known_types(found, self.profile))

    def compiled(self, types: KnownTypes) -> RuleSet:
        """The rules by these types. Raises as ``check_texts``."""
        tiers = tier_values_for(self.files, self.profile, self.resolve, types)
        rule_set = compile_rules(self.files, self.resolve, tiers, types)
        return replace(rule_set, anew=self) if rule_set.is_open else rule_set
