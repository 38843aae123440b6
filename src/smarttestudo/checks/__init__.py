# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The checker of rule files.

A theme is a module with lint rules. Tests have rule files for each, which the reference shows too.
"""

from smarttestudo.checks.checker import LINT_RULES, check_rules
from smarttestudo.checks.context import CheckContext

__all__ = ["LINT_RULES", "CheckContext", "check_rules"]
