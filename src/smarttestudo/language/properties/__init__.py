# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Properties of messages that checks read: names for the common types, any numeric field by its path."""

from smarttestudo.language.properties.accuracy import gauges_for, needs_decoded
from smarttestudo.language.properties.distances import wraps
from smarttestudo.language.properties.field_path import PropertySpec, Reader, is_field_path, part_reader
from smarttestudo.language.properties.signal_readers import SignalReader, reads_element, signal_reader
from smarttestudo.language.properties.table import (
    ARRIVAL_PROPERTIES,
    accuracy_properties_of,
    known_types,
    message_type,
    properties_for_bounds,
    properties_of,
    property_spec,
    value_reader,
)
from smarttestudo.language.properties.types_by_name import conventional_types
from smarttestudo.language.properties.vitals import SOURCE_MEANINGS

__all__ = [
    "ARRIVAL_PROPERTIES",
    "SOURCE_MEANINGS",
    "PropertySpec",
    "Reader",
    "SignalReader",
    "accuracy_properties_of",
    "conventional_types",
    "gauges_for",
    "is_field_path",
    "known_types",
    "message_type",
    "needs_decoded",
    "part_reader",
    "properties_for_bounds",
    "properties_of",
    "property_spec",
    "reads_element",
    "signal_reader",
    "value_reader",
    "wraps",
]
