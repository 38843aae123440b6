# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The checker: one file a check."""

from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.registry import CHECKS, check_rules
from smarttestudo.checks.rule_check import Example, RuleCheck

__all__ = ["CHECKS", "CheckContext", "Example", "RuleCheck", "check_rules"]
