# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""JSON that others read: statuses, decisions and recorded inputs."""
