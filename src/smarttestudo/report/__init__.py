# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run as one HTML file that needs nothing else, as tables, and as figures."""
