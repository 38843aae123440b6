# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as rosbag2 keeps them."""

from smarttestudo.adapters.rosbag.decoder import RosbagDecoder
from smarttestudo.adapters.rosbag.message_types import MessageTypes
from smarttestudo.adapters.rosbag.qos import qos_in_words
from smarttestudo.adapters.rosbag.reader import open_recording
from smarttestudo.adapters.rosbag.writer import create_recording

__all__ = ["MessageTypes", "RosbagDecoder", "create_recording", "open_recording", "qos_in_words"]
