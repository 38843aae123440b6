# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions of the ADIRF Ruler's page and their answers, without HTTP."""
