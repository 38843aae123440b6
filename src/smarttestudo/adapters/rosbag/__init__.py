# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""rosbag2 recordings: sqlite3 and MCAP, whole or cut off."""
