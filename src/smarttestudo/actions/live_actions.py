# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Does on a robot what the loop decides about actions, and says what came of it."""

from __future__ import annotations

import itertools
import secrets
import socket
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial

from smarttestudo.actions.notices import NoticeThrottle, SentNotice
from smarttestudo.actions.parameter_setter import ParameterSetter
from smarttestudo.actions.restore_file import RestoreFile
from smarttestudo.actions.webhook import Webhook
from smarttestudo.domain.action import ActionDecision, ActionEvent, ActionKind, Notice
from smarttestudo.domain.decision import AnyDecision, about_actions
from smarttestudo.domain.errors import TestudoError, said
from smarttestudo.domain.robot import Robot, ServiceAnswer
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import NS_PER_S, ns_from_s, utc_time
from smarttestudo.robot.part import Part, RunView

_FINISH_WITHIN_S = 3.0
MOST_NOTICES = 50
"""How many notices a status has at most."""


class LiveActions(Part):
    """Sets parameters, calls services and sends notices, unless the run ``is_dry``.

    All but a ``webhook`` is asked for on the thread of the run, which waits for no answer.
    """

    poll_s = 0.25

    def __init__(self, robot: Robot, file: RestoreFile, webhook: Webhook | None, *, is_dry: bool) -> None:
        self._robot = robot
        self._file = file
        self._webhook = webhook
        self._is_dry = is_dry
        self._run: RunView | None = None
        self._setter: ParameterSetter | None = None
        self._notices: dict[tuple[str | None, str], Notice] = {}
        self._throttle = NoticeThrottle()
        self._numbers = itertools.count(1)
        self._run_id = secrets.token_hex(8)
        self._finish_until_ns: int | None = None

    def running(self) -> AbstractContextManager[object]:
        """Send notices during the block."""
        return nullcontext() if self._webhook is None else self._webhook.running()

    def begin(self, run: RunView) -> None:
        """Give back what a run before has left."""
        self._run = run
        if self._is_dry:
            return
        try:
            left = self._file.read()
        except TestudoError as error:
            self._robot.log.warning(str(error))
            return
        if left:
            self._parameters.restore(left)

    def on_decisions(self, decisions: Sequence[AnyDecision]) -> None:
        """Do what was decided."""
        if self._finish_until_ns is not None:
            return
        for decision in about_actions(decisions):
            if decision.event.is_outcome or decision.event is ActionEvent.NOT_ALLOWED:
                continue
            try:
                self._do(decision)
            except Exception as error:  # noqa: BLE001 - one action that fails costs no other
                self._tell(decision, ActionEvent.FAILED, said(error))

    def _do(self, decision: ActionDecision) -> None:
        action = decision.action
        if self._is_dry:
            if decision.event is not ActionEvent.SKIPPED:
                self._tell(decision, ActionEvent.DRY, "")
        elif action.kind is ActionKind.NOTIFY:
            self._notify(decision)
        elif decision.event is ActionEvent.SKIPPED:
            return
        elif action.kind is ActionKind.SET_PARAMETER:
            self._parameters.take(decision)
        else:
            argument = action.value if isinstance(action.value, bool) else None
            called = partial(self._called, decision)
            self._robot.call_service(action.target, argument=argument, called=called)

    def _called(self, decision: ActionDecision, answer: ServiceAnswer | TestudoError) -> None:
        if isinstance(answer, TestudoError):
            self._tell(decision, ActionEvent.FAILED, answer.cause)
        else:
            event = ActionEvent.DONE if answer.is_success else ActionEvent.FAILED
            self._tell(decision, event, answer.message)

    def _notify(self, decision: ActionDecision) -> None:
        key = decision.rule, decision.action.target
        if decision.event is ActionEvent.END:
            self._notices.pop(key, None)
        else:
            self._notices[key] = Notice(
                text=decision.action.target, rule=decision.rule, since_ns=decision.stamp_ns
            )
        self._send(self._throttle.offer(decision, self._robot.steady_ns()))

    def _send(self, messages: Iterable[SentNotice]) -> None:
        for message in messages:
            if self._webhook is not None:
                self._webhook.put(self._body(message))

    def _body(self, message: SentNotice) -> dict[str, object]:
        decision = message.decision
        is_end = decision.event is ActionEvent.END
        return {
            "id": f"{self._run_id}-{next(self._numbers)}",
            "event": "end" if is_end else "begin",
            "text": decision.action.target,
            "rule": decision.rule,
            "time": utc_time(decision.stamp_ns),
            "stamp_ns": decision.stamp_ns,
            "count": message.count,
            "lasted_s": decision.lasted_s,
            "values": dict(decision.values),
            "node": self._robot.name,
            "host": socket.gethostname(),
        }

    def poll(self) -> None:
        """Send what flickered, and ask nodes again that were not there."""
        self._send(self._throttle.advance(self._robot.steady_ns()))
        if self._setter is not None:
            self._setter.poll()

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        """``status`` with the notices that hold."""
        return replace(status, notices=tuple(self._notices.values())[:MOST_NOTICES])

    def finish(self) -> None:
        """Give all parameters back; what rules decide from now on is not done."""
        self._send(self._throttle.flush())
        self._finish_until_ns = self._robot.steady_ns() + ns_from_s(_FINISH_WITHIN_S)
        if self._setter is not None:
            self._setter.give_all_back()

    @property
    def is_busy(self) -> bool:
        """Whether a node has not answered yet, and may."""
        until_ns = self._finish_until_ns
        is_in_time = until_ns is not None and self._robot.steady_ns() < until_ns
        return is_in_time and self._setter is not None and self._setter.is_busy

    def close(self) -> None:
        """Say what could not be given back."""
        if self._setter is not None and self._setter.left:
            places = ", ".join(self._setter.left)
            self._robot.log.warning(f"not given back, which the next run does: {places}")

    @property
    def _parameters(self) -> ParameterSetter:
        robot = self._robot
        if self._setter is None:
            self._setter = ParameterSetter(
                robot.remote_parameters, self._file, self._tell, lambda: robot.steady_ns() / NS_PER_S
            )
        return self._setter

    def _tell(self, decision: ActionDecision, event: ActionEvent, detail: str) -> None:
        run = self._run
        if run is not None:
            now_ns = self._robot.now_ns()
            t_s = (now_ns - run.loop.knowledge.start_ns) / NS_PER_S
            run.note(decision.outcome(event, t_s=t_s, stamp_ns=now_ns, detail=detail))
