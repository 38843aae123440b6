# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Pushed rules written to the rule file of a live run, where whoever started it consents."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from smarttestudo.domain.errors import RuleFileError, UsageError
from smarttestudo.rules.rule_files import PREVIOUS_SUFFIX, find_rule_files, is_missing, replace_rule_text

_PLACE = "write_hash"


class RuleFileWriter:
    """Writes to the one rule file that ``rules`` names, if ``is_allowed``."""

    def __init__(self, rules: Sequence[Path], *, is_allowed: bool) -> None:
        self._rules = rules
        self._is_allowed = is_allowed

    @property
    def file(self) -> str:
        """The file that would be written; empty where none may be."""
        files = self._files() if self._is_allowed else []
        return str(files[0]) if len(files) == 1 else ""

    def write(self, text: str, loaded: Mapping[str, str]) -> str:
        """Write ``text`` to the file, which held what is in ``loaded``; what was done, in words.

        Raises ``UsageError`` where that is not allowed, and like ``replace_rule_text``.
        """
        if not self._is_allowed:
            remedy = "start the runtime with --allow-writing-rules"
            raise UsageError("pushed rules may not be written to files here", place=_PLACE, remedy=remedy)
        files = self._files()
        if len(files) != 1:
            cause = f"pushed rules are one text, and the runtime has {len(files) or 'no'} rule files"
            raise UsageError(cause, place=_PLACE, remedy="start it with one rule file")
        path = files[0]
        replace_rule_text(path, text, loaded.get(str(path)))
        kept = f"; what it held is in {path.name}{PREVIOUS_SUFFIX}" if str(path) in loaded else ""
        return f"pushed rules written to {path}{kept}"

    def _files(self) -> list[Path]:
        """The rule files; a single one that is named need not be there yet."""
        if len(self._rules) == 1 and is_missing(self._rules[0]):
            return list(self._rules)
        try:
            return find_rule_files(self._rules)
        except RuleFileError:
            return []
