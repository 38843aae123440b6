# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Estimate that a receiver shows of a topic between two messages, and its distance from the robot.

Standard library only.
"""
