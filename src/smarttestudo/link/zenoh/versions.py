# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Ends of a link that speak another version of its protocol."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.link.protocol.wire import other_version, version_sentence
from smarttestudo.link.zenoh.keys import Boot

OPERATOR = "an operator's end"
_MOST = 1_000


def robot_peer(boot: Boot) -> str:
    """The name of a robot's end in a sentence."""
    return f"robot {boot.robot}"


class OtherVersions:
    """Tells ``warn`` once of each peer that speaks another version; what it sends is lost.

    ``present`` has what is to be said of each peer that is there.
    """

    def __init__(self, warn: Callable[[str], None] = lambda _: None) -> None:
        self.present: dict[str, str] = {}
        self._warn = warn
        self._said: set[str] = set()

    def look(self, peer: str, data: bytes) -> None:
        """Look at what came of ``peer``."""
        version = other_version(data)
        if version is None or len(self._said) >= _MOST:
            return
        sentence = self.present[peer] = version_sentence(peer, version)
        if sentence not in self._said:
            self._said.add(sentence)
            self._warn(sentence)

    def leave(self, peer: str) -> None:
        """A peer is gone."""
        self.present.pop(peer, None)
