# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles from measurements: sizes, rates, and a first proposal of tiers."""
