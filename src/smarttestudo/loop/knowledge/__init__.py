# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Knowledge: the loop's whole state, one instance, owned by the loop."""
