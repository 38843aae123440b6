# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What parsing a rule file gives."""

from __future__ import annotations

from dataclasses import dataclass

from smarttestudo.adirf.parser.tokens import Token
from smarttestudo.adirf.syntax import RuleFile
from smarttestudo.domain.finding import Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class ParseResult:
    """The statements of ``file`` that are whole, and an error for each that is not, in the order of the file.

    ``tokens`` end with the one that stands for the file's end; their comments are all comments of the file.
    ``steps`` is how often the parser looked at a token.
    """

    file: RuleFile
    findings: tuple[Finding, ...]
    tokens: tuple[Token, ...]
    steps: int

    @property
    def is_valid(self) -> bool:
        """Whether the file has no error of syntax."""
        return not self.findings
