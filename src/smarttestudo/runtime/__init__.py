# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The MAPE-K loop as a pure step; time and I/O are passed in. Standard library only."""
