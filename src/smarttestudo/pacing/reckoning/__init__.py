# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a receiver shows of a topic between two messages, and how far that is from the robot.

Standard library only.
"""
