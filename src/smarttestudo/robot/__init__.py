# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop beside a running robot: topics, rules, status, and the node on its ROS graph."""
