# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of a link in virtual time: what is sent next, how much is under way, what arrived."""
