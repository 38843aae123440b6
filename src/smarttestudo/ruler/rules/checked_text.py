# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file's text with its statements and findings; what has errors does not leave."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from msgspec import Struct

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import counted
from smarttestudo.editing import Document, read_document
from smarttestudo.rules.profile_file import parse_profile

WAY_TO_PROFILE = "choose or create a profile: its topic parameters say what each quality level is in Hz"


class Draft(Struct, frozen=True, kw_only=True):
    """A rule file as an editor holds it, with the text of its profile; findings call them by the names.

    Texts come and go whole. ``POST /api/document`` → ``RuleDocument``; ``/api/zones`` → ``ZonesAnswer``.
    """

    text: str
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"

    def profile(self) -> Profile | None:
        """The profile; ``ProfileError`` for one that cannot be read."""
        return (
            None if self.profile_text is None else parse_profile(self.profile_text, Path(self.profile_name))
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedText:
    """The statements of a text, and the checker's findings."""

    document: Document
    findings: tuple[Finding, ...]

    @property
    def has_errors(self) -> bool:
        """Whether a finding stops the file from being used."""
        return any(finding.severity is Severity.ERROR for finding in self.findings)


class RefusedTextError(RuleFileError):
    """Rules with errors, which stay where they are; ``checked`` has the findings."""

    def __init__(self, checked: CheckedText) -> None:
        errors = [one for one in checked.findings if one.severity is Severity.ERROR]
        super().__init__(
            f"the rules have {counted(len(errors), 'error')}: {errors[0].message}",
            place=f"{errors[0].path}:{errors[0].span.line}:{errors[0].span.column}",
            remedy="fix them first",
        )
        self.checked = checked


def check_text(draft: Draft) -> CheckedText:
    """Read and check ``draft``; ``ProfileError`` for a profile that cannot be read."""
    document = read_document(draft.text, draft.name)
    context = CheckContext(profile=draft.profile(), way_to_profile=WAY_TO_PROFILE)
    return CheckedText(document=document, findings=tuple(check_rules([document.result], context)))


def require_usable(draft: Draft) -> CheckedText:
    """``check_text``, but ``RefusedTextError`` for rules with errors."""
    return _without_errors(check_text(draft))


def check_sound(text: str, name: str) -> CheckedText:
    """Read and check rules that meet their profile elsewhere, so that levels need no rate here."""
    document = read_document(text, name)
    findings = check_rules([document.result], CheckContext(profile=Profile()))
    return CheckedText(document=document, findings=tuple(findings))


def require_sound(text: str, name: str) -> CheckedText:
    """``check_sound``, but ``RefusedTextError`` for rules with errors."""
    return _without_errors(check_sound(text, name))


def _without_errors(checked: CheckedText) -> CheckedText:
    if checked.has_errors:
        raise RefusedTextError(checked)
    return checked
