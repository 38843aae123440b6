# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Figures for papers and slides, drawn with matplotlib; the only importer of it."""
