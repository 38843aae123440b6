# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The checker of rule files.

A theme is a module with its ``CHECKS``, and beside it a case file of its name, which explains and shows each.
"""

from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.registry import CHECKS, check_rules
from smarttestudo.checks.rule_check import RuleCheck

__all__ = ["CHECKS", "CheckContext", "RuleCheck", "check_rules"]
