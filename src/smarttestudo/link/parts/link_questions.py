# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Answers what is asked over a link, between two messages."""

from __future__ import annotations

from smarttestudo.domain.errors import TestudoError, testudo_error
from smarttestudo.domain.link import OutgoingLink
from smarttestudo.domain.parameter import Answer, GetParameters, GetTopics, Question, SetParameters
from smarttestudo.domain.robot import Robot, topic_types
from smarttestudo.domain.units import NS_PER_S

QUESTION_PERIOD_S = 0.1
"""How often one question is answered: more would keep messages waiting."""
_TOPICS_HOLD_NS = 2 * NS_PER_S


class LinkQuestions:
    """Answers the questions that wait at ``link`` on the thread of ``robot``, one at a time."""

    def __init__(self, robot: Robot, link: OutgoingLink) -> None:
        self._robot = robot
        self._link = link
        self._topics: Answer = {}
        self._polled_ns: int | None = None
        robot.every(QUESTION_PERIOD_S, self._poll)

    def _poll(self) -> None:
        asked = self._link.take_question()
        if asked is None:
            return
        answer: Answer | TestudoError
        try:
            answer = self._answer(asked.question)
        except Exception as error:  # noqa: BLE001 - whatever a stranger asks, relaying goes on
            answer = testudo_error(error)
        asked.answer(answer)

    def _answer(self, question: Question) -> Answer:
        match question:
            case GetParameters(names=names):
                return self._robot.parameters(names)
            case SetParameters(values=values):
                return self._robot.set_parameters(values)
            case GetTopics():
                return self._all_topics()

    def _all_topics(self) -> Answer:
        now_ns = self._robot.steady_ns()
        if self._polled_ns is None or now_ns > self._polled_ns + _TOPICS_HOLD_NS:
            self._topics, self._polled_ns = topic_types(self._robot), now_ns
        return self._topics
