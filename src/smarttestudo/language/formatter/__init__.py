# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Syntax tree to text: the house style of rule files."""

from smarttestudo.language.formatter.rule_file import (
    first_line_end,
    format_condition,
    format_file,
    format_heading,
    format_rules,
    format_statement,
)
from smarttestudo.language.formatter.text import number_text

__all__ = [
    "first_line_end",
    "format_condition",
    "format_file",
    "format_heading",
    "format_rules",
    "format_statement",
    "number_text",
]
