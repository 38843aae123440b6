# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The warehouse demo: a simulated mission, recorded, replayed under rules, and shown."""
