# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Standard types whose constants rules name, for where nothing is installed that knows them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from smarttestudo.domain.type_definition import FieldType, TypeDefinition


def _numbered(prefix: str, names: str, start: int = 0, step: int = 1) -> dict[str, float]:
    return {f"{prefix}{name}": float(start + step * at) for at, name in enumerate(names.split())}


def _type(
    constants: Mapping[str, float] | None = None, inner: Mapping[str, FieldType] | None = None, **fields: str
) -> TypeDefinition:
    """A type with these constants and fields; fields that hold no word are left out."""
    plain = {name: FieldType(name=of) for name, of in fields.items()}
    return TypeDefinition(fields={**plain, **(inner or {})}, constants=constants or {})


def _many(name: str) -> FieldType:
    return FieldType(name=name, is_array=True)


STANDARD_TYPES: Mapping[str, TypeDefinition] = MappingProxyType(
    {
        "action_msgs/msg/GoalStatus": _type(
            _numbered("STATUS_", "UNKNOWN ACCEPTED EXECUTING CANCELING SUCCEEDED CANCELED ABORTED"),
            status="int8",
        ),
        "action_msgs/msg/GoalStatusArray": _type(inner={"status_list": _many("action_msgs/msg/GoalStatus")}),
        "diagnostic_msgs/msg/DiagnosticStatus": _type(
            _numbered("", "OK WARN ERROR STALE"),
            level="byte",
            name="string",
            message="string",
            hardware_id="string",
        ),
        "diagnostic_msgs/msg/DiagnosticArray": _type(
            inner={"status": _many("diagnostic_msgs/msg/DiagnosticStatus")}
        ),
        "lifecycle_msgs/msg/State": _type(
            {
                **_numbered("PRIMARY_STATE_", "UNKNOWN UNCONFIGURED INACTIVE ACTIVE FINALIZED"),
                **_numbered(
                    "TRANSITION_STATE_",
                    "CONFIGURING CLEANINGUP SHUTTINGDOWN ACTIVATING DEACTIVATING ERRORPROCESSING",
                    10,
                ),
            },
            id="uint8",
            label="string",
        ),
        "lifecycle_msgs/msg/Transition": _type(
            _numbered(
                "TRANSITION_",
                "CREATE CONFIGURE CLEANUP ACTIVATE DEACTIVATE UNCONFIGURED_SHUTDOWN INACTIVE_SHUTDOWN "
                "ACTIVE_SHUTDOWN DESTROY",
            ),
            id="uint8",
            label="string",
        ),
        "lifecycle_msgs/msg/TransitionEvent": _type(
            timestamp="uint64",
            transition="lifecycle_msgs/msg/Transition",
            start_state="lifecycle_msgs/msg/State",
            goal_state="lifecycle_msgs/msg/State",
        ),
        "rcl_interfaces/msg/Log": _type(
            _numbered("", "DEBUG INFO WARN ERROR FATAL", 10, 10),
            level="uint8",
            name="string",
            msg="string",
            file="string",
            function="string",
            line="uint32",
        ),
        "sensor_msgs/msg/BatteryState": _type(
            {
                **_numbered("POWER_SUPPLY_STATUS_", "UNKNOWN CHARGING DISCHARGING NOT_CHARGING FULL"),
                **_numbered(
                    "POWER_SUPPLY_HEALTH_",
                    "UNKNOWN GOOD OVERHEAT DEAD OVERVOLTAGE UNSPEC_FAILURE COLD WATCHDOG_TIMER_EXPIRE "
                    "SAFETY_TIMER_EXPIRE",
                ),
                **_numbered("POWER_SUPPLY_TECHNOLOGY_", "UNKNOWN NIMH LION LIPO LIFE NICD LIMN"),
            },
            power_supply_status="uint8",
            power_supply_health="uint8",
            power_supply_technology="uint8",
            present="bool",
            location="string",
            serial_number="string",
        ),
        "sensor_msgs/msg/NavSatFix": _type(
            _numbered("COVARIANCE_TYPE_", "UNKNOWN APPROXIMATED DIAGONAL_KNOWN KNOWN"),
            status="sensor_msgs/msg/NavSatStatus",
            position_covariance_type="uint8",
        ),
        "sensor_msgs/msg/NavSatStatus": _type(
            {
                **_numbered("STATUS_", "NO_FIX FIX SBAS_FIX GBAS_FIX", -1),
                "SERVICE_GPS": 1.0,
                "SERVICE_GLONASS": 2.0,
                "SERVICE_COMPASS": 4.0,
                "SERVICE_GALILEO": 8.0,
            },
            status="int8",
            service="uint16",
        ),
    }
)
"""By name; not all of their fields."""
