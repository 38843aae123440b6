# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a check can read of a message: names for the common types, any numeric field by its path."""

from smarttestudo.language.properties.accuracy import (
    accuracy_properties_of,
    gauges_for,
    needs_decoded,
    properties_for_bounds,
    wraps,
)
from smarttestudo.language.properties.field_path import (
    PropertySpec,
    Reader,
    is_field_path,
    part_reader,
)
from smarttestudo.language.properties.table import (
    ARRIVAL_PROPERTIES,
    known_types,
    properties_of,
    property_spec,
    value_reader,
)
from smarttestudo.language.properties.usual_types import usual_types

__all__ = [
    "ARRIVAL_PROPERTIES",
    "PropertySpec",
    "Reader",
    "accuracy_properties_of",
    "gauges_for",
    "is_field_path",
    "known_types",
    "needs_decoded",
    "part_reader",
    "properties_for_bounds",
    "properties_of",
    "property_spec",
    "usual_types",
    "value_reader",
    "wraps",
]
