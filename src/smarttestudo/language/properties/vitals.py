# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Properties of the robot's computer and of its link."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from smarttestudo.domain.names import LINK, MACHINE
from smarttestudo.language.properties.field_path import PropertySpec

SOURCE_MEANINGS: Mapping[str, str] = MappingProxyType(
    {MACHINE: "the robot's computer", LINK: "the link to the operators"}
)
"""What checks can name in the place of a topic."""


def _vitals(*specs: PropertySpec) -> Mapping[str, PropertySpec]:
    return MappingProxyType({spec.name: spec for spec in specs})


VITALS: Mapping[str, Mapping[str, PropertySpec]] = MappingProxyType(
    {
        MACHINE: _vitals(
            PropertySpec(
                name="cpu", unit="%", meaning="share of all cores that is busy", minimum=0.0, maximum=100.0
            ),
            PropertySpec(
                name="memory", unit="%", meaning="share of the memory in use", minimum=0.0, maximum=100.0
            ),
            PropertySpec(
                name="temperature", unit="°C", meaning="hottest sensor", minimum=-60.0, maximum=125.0
            ),
            PropertySpec(
                name="disk_free",
                unit="GB",
                meaning="free on the disk of --incidents, else of the working folder",
                minimum=0.0,
            ),
            PropertySpec(
                name="wifi_signal", unit="dBm", meaning="strongest Wi-Fi signal", minimum=-150.0, maximum=0.0
            ),
        ),
        LINK: _vitals(
            PropertySpec(
                name="capacity",
                unit="KB/s",
                meaning="bandwidth that the link carries, where it is the limit",
                minimum=0.0,
            ),
            PropertySpec(
                name="round_trip", unit="ms", meaning="least round trip of the last 10 s", minimum=0.0
            ),
            PropertySpec(
                name="used", unit="%", meaning="share of the capacity in use", minimum=0.0, maximum=100.0
            ),
            PropertySpec(
                name="connected",
                unit="",
                meaning="true while an operator is there, else false",
                minimum=0.0,
                maximum=1.0,
            ),
            PropertySpec(
                name="age",
                unit="s",
                meaning="time since anything arrived at the operator, or since the start",
                minimum=0.0,
            ),
        ),
    }
)
"""What checks read of the machine and the link, which are like types of their own."""
