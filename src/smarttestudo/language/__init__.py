# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ADIRF, the rule language: text to syntax tree and meaning. Standard library only."""
