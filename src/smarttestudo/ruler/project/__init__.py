# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A project's folder: its files, its settings, the versions of its rule files, and its maps."""
