# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run as one HTML file that needs nothing else: no network, and scripts only for comfort."""

from smarttestudo.visualizer.report.document import render_report
from smarttestudo.visualizer.report.run_report import Fact, RuleText, RunReport, TopicHistory, TopicSeries

__all__ = ["Fact", "RuleText", "RunReport", "TopicHistory", "TopicSeries", "render_report"]
