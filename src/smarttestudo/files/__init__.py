# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files: read without waiting, written whole or not at all, removed only where they are ours."""
