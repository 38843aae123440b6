# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots with masses, forces and contacts, in the warehouse; MuJoCo is imported in ``engine`` only."""
