# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An incident on its way over a link: what there is of it, in which order it travels, and what is there."""
