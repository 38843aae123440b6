# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What people do with SmartTestudo, one folder each: the only layer that joins adapters to the pure code."""
