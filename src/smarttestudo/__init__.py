# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SmartTestudo: adaptive monitoring for ROS 2 robots."""

__version__ = "0.1.0"
