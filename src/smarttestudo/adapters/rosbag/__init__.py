# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as rosbag2 keeps them."""

from smarttestudo.adapters.rosbag.definitions import MessageTypes, RosbagDecoder
from smarttestudo.adapters.rosbag.qos import qos_in_words
from smarttestudo.adapters.rosbag.reader import open_recording
from smarttestudo.adapters.rosbag.recording_sink import RecordingSink
from smarttestudo.adapters.rosbag.writer import create_recording

__all__ = [
    "MessageTypes",
    "RecordingSink",
    "RosbagDecoder",
    "create_recording",
    "open_recording",
    "qos_in_words",
]
