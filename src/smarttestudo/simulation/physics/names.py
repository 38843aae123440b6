# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names that the model and its readers share."""

from __future__ import annotations

FLOOR = "floor"
LIDAR_COVER = "lidar_cover"
HIDDEN_GROUP = 4
"""The group of geometry that neither rays nor cameras see."""
