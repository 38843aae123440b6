# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings: rosbag2 and MCAP, whole or damaged, and what they hold in numbers."""
