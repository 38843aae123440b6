# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page of the ADIRF Ruler: its project on disk, its answers, and the server in front of them."""
