# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The load of blocks together: every situation that the rules allow, and which break the budget.

``clusters`` groups blocks that depend on each other, ``cells`` finds which blocks of a cluster can hold
together, ``loads`` says what a topic takes, ``check`` joins the clusters and finds what is too much.
"""
