# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which messages of a stream a relay passes: deadline grids with capped credit. Standard library only."""
