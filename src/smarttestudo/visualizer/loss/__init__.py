# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator loses when topics are thinned: errors of fields, ages, crossings, images, by rate too."""

from smarttestudo.visualizer.loss.report import (
    Age,
    Carried,
    CrossingLoss,
    ErrorSize,
    FieldError,
    FieldLoss,
    Frames,
    ImageLoss,
    LossReport,
    Sightings,
    TopicArm,
    TopicLoss,
)

__all__ = [
    "Age",
    "Carried",
    "CrossingLoss",
    "ErrorSize",
    "FieldError",
    "FieldLoss",
    "Frames",
    "ImageLoss",
    "LossReport",
    "Sightings",
    "TopicArm",
    "TopicLoss",
]
