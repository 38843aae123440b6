# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text to syntax tree: recursive descent with one token of lookahead, recovering at statement keywords."""

from smarttestudo.language.parser.rule_file import MAX_FILE_BYTES, ParseResult, parse

__all__ = ["MAX_FILE_BYTES", "ParseResult", "parse"]
