# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How far an operator's picture is off: at fixed rates, under bounds, and under rules."""
