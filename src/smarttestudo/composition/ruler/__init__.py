# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the ADIRF Ruler can do with texts, profiles, bags and a project folder, without HTTP."""
