# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ROS messages of what a robot with physics measures beside the others: its battery, and what is below it."""

from __future__ import annotations

from typing import Any

import numpy as np
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__BatteryState as BatteryStateMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__Range as HumbleRangeMessage
from rosbags.typesys.stores.ros2_jazzy import sensor_msgs__msg__Range as JazzyRangeMessage

from smarttestudo.simulation.messages.motion import header
from smarttestudo.simulation.readings import BatteryLevelReading, RangeReading
from smarttestudo.simulation.robot import BASE_LINK, RANGE_FRAME


def battery_state(reading: BatteryLevelReading) -> BatteryStateMessage:
    """A sensor_msgs/msg/BatteryState of a lithium polymer battery; what is not measured is NaN."""
    unknown = np.zeros(0, np.float32)
    return BatteryStateMessage(
        header=header(reading.stamp_ns, BASE_LINK),
        voltage=reading.voltage_v,
        temperature=float("nan"),
        current=-reading.current_a,
        charge=reading.share * reading.capacity_ah,
        capacity=reading.capacity_ah,
        design_capacity=reading.capacity_ah,
        percentage=reading.share,
        power_supply_status=BatteryStateMessage.POWER_SUPPLY_STATUS_DISCHARGING,
        power_supply_health=BatteryStateMessage.POWER_SUPPLY_HEALTH_GOOD,
        power_supply_technology=BatteryStateMessage.POWER_SUPPLY_TECHNOLOGY_LIPO,
        present=True,
        cell_voltage=unknown,
        cell_temperature=unknown,
        location="",
        serial_number="",
    )


def humble_range(reading: RangeReading) -> HumbleRangeMessage:
    """A sensor_msgs/msg/Range as ROS 2 Humble has it."""
    return HumbleRangeMessage(**_range_fields(reading))


def jazzy_range(reading: RangeReading) -> JazzyRangeMessage:
    """A sensor_msgs/msg/Range as later releases have it, with an unknown variance."""
    return JazzyRangeMessage(**_range_fields(reading), variance=0.0)


def _range_fields(reading: RangeReading) -> dict[str, Any]:
    """Fields that all releases have."""
    return {
        "header": header(reading.stamp_ns, RANGE_FRAME),
        "radiation_type": HumbleRangeMessage.INFRARED,
        "field_of_view": reading.field_of_view_rad,
        "min_range": reading.range_min_m,
        "max_range": reading.range_max_m,
        "range": reading.range_m,
    }
