# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The link between a robot and its operators: the protocol, Zenoh under it, and what receives."""
