# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The words of the product: rates, topics, findings, observations, decisions. Standard library only."""
