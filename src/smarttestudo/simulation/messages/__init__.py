# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The readings of the simulated robot as the messages of a ROS 2 robot."""
