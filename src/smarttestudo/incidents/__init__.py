# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents: messages around a moment, in memory and on disk. Standard library only."""
