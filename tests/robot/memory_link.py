# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link in memory."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from smarttestudo.domain.link import (
    LinkNeeds,
    LinkState,
    MessageOrigin,
    MissedMessage,
    Prediction,
    StreamCounts,
    StreamInfo,
)
from smarttestudo.domain.parameter import Asked
from smarttestudo.domain.robot import Publisher


class MemoryLink:
    """An ``OutgoingLink`` that keeps what it is told; the test says what it carries."""

    def __init__(self) -> None:
        self.state = LinkState(is_connected=True)
        self.budget_kb_per_s: float | None = None
        self.robot = "ada"
        self.is_settled = True
        self.is_watched = False
        self.missed: list[MissedMessage] = []
        self.origin: Callable[[], MessageOrigin | None] = lambda: None
        self.told: list[Mapping[str, object]] = []
        self.followed: list[Mapping[str, LinkNeeds]] = []
        self.predicted: list[tuple[Mapping[str, Prediction], Collection[str]]] = []

    def advertise(self, stream: StreamInfo) -> Publisher:
        raise NotImplementedError

    def follow(self, needs: Mapping[str, LinkNeeds]) -> None:
        self.followed.append(needs)

    def predict(self, predictions: Mapping[str, Prediction], anew: Collection[str]) -> None:
        self.predicted.append((predictions, anew))

    def tell(self, status: Mapping[str, object]) -> None:
        self.told.append(status)

    def keep_missed(self, origin: Callable[[], MessageOrigin | None]) -> None:
        self.origin = origin

    def take_missed(self, *, is_last: bool = False) -> list[MissedMessage]:
        missed, self.missed = self.missed, []
        return missed

    def take_question(self) -> Asked | None:
        raise NotImplementedError

    def offer_incidents(self, folder: Path) -> None:
        raise NotImplementedError

    def counts(self) -> dict[str, StreamCounts]:
        return {}

    def age_ms(self, topic: str) -> float | None:
        raise NotImplementedError
