# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The conditions of all blocks beside each other."""

from smarttestudo.checks.analysis.interval_analysis import analyse, wins_over
from smarttestudo.checks.analysis.results import Analysis, Clash, Gap, RedundantRate, Shadow, SharedBorder

__all__ = ["Analysis", "Clash", "Gap", "RedundantRate", "Shadow", "SharedBorder", "analyse", "wins_over"]
