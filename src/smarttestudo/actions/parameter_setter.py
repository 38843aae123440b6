# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sets parameters of other nodes while rules hold, and gives them their values back."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial

from smarttestudo.actions.restore_file import RestoreFile, ValueBefore
from smarttestudo.domain.action import (
    ActionDecision,
    ActionEvent,
    ActionKind,
    ActRequest,
    SetValue,
    value_text,
)
from smarttestudo.domain.errors import TestudoError, said
from smarttestudo.domain.parameter import ParameterValue, Refusals, RemoteParameters, Values

RETRY_AFTER_S = 5.0
"""How long after a node was not there it is asked again."""

Tell = Callable[[ActionDecision, ActionEvent, str], None]
"""Takes what came of an action, with the answer or the reason."""


@dataclass(slots=True, eq=False)
class _Parameter:
    """State of one parameter: its value ``before``, and those of ours that it may have now.

    Without a value before, nothing has to be given back. One request is under way at a time; of those that
    come meanwhile, the last one is ``waiting``.
    """

    node: str
    name: str
    before: SetValue | None = None
    given: list[SetValue] = field(default_factory=list)
    waiting: ActionDecision | None = None
    is_busy: bool = False
    retry_s: float | None = None


class ParameterSetter:
    """Sets parameters by ``remote``, and has ``file`` remember what they were; nothing waits for a node."""

    def __init__(
        self, remote: RemoteParameters, file: RestoreFile, tell: Tell, steady_s: Callable[[], float]
    ) -> None:
        self._remote = remote
        self._file = file
        self._tell = tell
        self._steady_s = steady_s
        self._parameters: dict[str, _Parameter] = {}

    def restore(self, values: Iterable[ValueBefore]) -> None:
        """Give back what a run before has left."""
        for one in values:
            parameter = _Parameter(node=one.node, name=one.parameter, before=one.value, given=list(one.given))
            self._parameters[_giving_back(parameter).action.place] = parameter
            self._request(parameter, _giving_back(parameter))

    def take(self, decision: ActionDecision) -> None:
        """Do what was decided: set a parameter, or give it back where the action has no value."""
        action = decision.action
        parameter = self._parameters.setdefault(
            action.place, _Parameter(node=action.target, name=action.parameter)
        )
        self._request(parameter, decision)

    def give_all_back(self) -> None:
        """Give back all that is set."""
        for parameter in [*self._parameters.values()]:
            if parameter.before is not None or parameter.is_busy:
                self._request(parameter, _giving_back(parameter))

    def poll(self) -> None:
        """Ask those again that were not there."""
        now_s = self._steady_s()
        for parameter in [*self._parameters.values()]:
            if parameter.retry_s is not None and now_s >= parameter.retry_s:
                self._request(parameter, _giving_back(parameter), is_retry=True)

    @property
    def is_busy(self) -> bool:
        """Whether the answer of a node is awaited."""
        return any(parameter.is_busy for parameter in self._parameters.values())

    @property
    def left(self) -> tuple[str, ...]:
        """The parameters that still have a value of ours."""
        return tuple(place for place, one in self._parameters.items() if one.before is not None)

    def _request(self, parameter: _Parameter, decision: ActionDecision, *, is_retry: bool = False) -> None:
        if parameter.is_busy:
            if parameter.waiting is not None and parameter.waiting.action.value is not None:
                self._tell(parameter.waiting, ActionEvent.FAILED, "the node was busy until the next change")
            parameter.waiting = decision
            return
        parameter.is_busy, parameter.retry_s = True, None
        self._remote.get(
            parameter.node, [parameter.name], partial(self._got, parameter, decision, is_retry=is_retry)
        )

    def _got(
        self,
        parameter: _Parameter,
        decision: ActionDecision,
        answer: Values | TestudoError,
        *,
        is_retry: bool,
    ) -> None:
        is_giving_back = decision.action.value is None
        if isinstance(answer, TestudoError):
            if is_giving_back and parameter.before is not None:
                parameter.retry_s = self._steady_s() + RETRY_AFTER_S
            self._done(parameter, None if is_retry else decision, ActionEvent.FAILED, answer.cause)
        elif is_giving_back:
            self._give_back(parameter, decision, answer.get(parameter.name))
        else:
            self._set(parameter, decision, answer.get(parameter.name))

    def _set(self, parameter: _Parameter, decision: ActionDecision, now: ParameterValue) -> None:
        before, wanted = parameter.before, decision.action.value
        assert wanted is not None
        if not isinstance(now, SetValue):
            why = "the node has no such parameter, or it is not set"
            if now is not None:
                why = "it is a list, which could not be given back"
            self._done(parameter, decision, ActionEvent.FAILED, why)
            return
        if before is not None and not _is_among(now, (before, *parameter.given)):
            self._leave(parameter, decision, now)
            return
        value = float(wanted) if isinstance(now, float) and type(wanted) is int else wanted
        if before is None and _is_same(value, now):
            self._done(parameter, decision, ActionEvent.DONE, "it has that value already")
            return
        parameter.before = now if before is None else before
        parameter.given.append(value)
        try:
            self._write()
        except TestudoError as error:
            parameter.given.pop()
            parameter.before = before
            self._done(parameter, decision, ActionEvent.FAILED, said(error))
            return
        self._remote.set(
            parameter.node, {parameter.name: value}, partial(self._was_set, parameter, decision, value, now)
        )

    def _was_set(
        self,
        parameter: _Parameter,
        decision: ActionDecision,
        value: SetValue,
        before: SetValue,
        answer: Refusals | TestudoError,
    ) -> None:
        if isinstance(answer, TestudoError):
            # It may have been set, and is given back in any case.
            self._done(parameter, decision, ActionEvent.FAILED, answer.cause)
        elif parameter.name in answer:
            parameter.given = [one for one in parameter.given if not _is_same(one, value)]
            self._forget_unless(parameter, is_ours=bool(parameter.given))
            self._done(parameter, decision, ActionEvent.FAILED, f"refused: {answer[parameter.name]}")
        else:
            parameter.given = [value]
            self._forget_unless(parameter, is_ours=True)
            self._done(parameter, decision, ActionEvent.DONE, f"it was {value_text(before)}")

    def _give_back(self, parameter: _Parameter, decision: ActionDecision, now: ParameterValue) -> None:
        before = parameter.before
        if before is None:
            self._done(parameter, decision, ActionEvent.DONE, "nothing was set")
        elif _is_same(now, before):
            self._forget_unless(parameter, is_ours=False)
            self._done(parameter, decision, ActionEvent.DONE, f"it is {value_text(before)}")
        elif not _is_among(now, parameter.given):
            self._leave(parameter, decision, now)
        else:
            self._remote.set(
                parameter.node,
                {parameter.name: before},
                partial(self._was_given_back, parameter, decision, before),
            )

    def _was_given_back(
        self,
        parameter: _Parameter,
        decision: ActionDecision,
        before: SetValue,
        answer: Refusals | TestudoError,
    ) -> None:
        if isinstance(answer, TestudoError):
            parameter.retry_s = self._steady_s() + RETRY_AFTER_S
            self._done(parameter, decision, ActionEvent.FAILED, answer.cause)
            return
        self._forget_unless(parameter, is_ours=False)
        if parameter.name in answer:
            self._done(parameter, decision, ActionEvent.FAILED, f"refused: {answer[parameter.name]}")
        else:
            self._done(parameter, decision, ActionEvent.DONE, f"it is {value_text(before)} again")

    def _leave(self, parameter: _Parameter, decision: ActionDecision, now: ParameterValue) -> None:
        self._forget_unless(parameter, is_ours=False)
        why = "the node has it no more" if now is None else f"it is {value_text(now)}, which was not set here"
        self._done(parameter, decision, ActionEvent.LEFT_ALONE, why)

    def _forget_unless(self, parameter: _Parameter, *, is_ours: bool) -> None:
        """Have the file say what is set now."""
        if not is_ours:
            parameter.before, parameter.given = None, []
        try:
            self._write()
        except TestudoError:
            # The file says more than is set, and a value that is not ours is left alone.
            return

    def _done(
        self, parameter: _Parameter, decision: ActionDecision | None, event: ActionEvent, detail: str
    ) -> None:
        parameter.is_busy = False
        if decision is not None:
            self._tell(decision, event, detail)
        waiting, parameter.waiting = parameter.waiting, None
        if waiting is not None:
            self._request(parameter, waiting)
        elif parameter.before is None:
            self._parameters.pop(_giving_back(parameter).action.place, None)

    def _write(self) -> None:
        self._file.write(
            ValueBefore(node=one.node, parameter=one.name, value=one.before, given=tuple(one.given))
            for one in self._parameters.values()
            if one.before is not None
        )


def _giving_back(parameter: _Parameter) -> ActionDecision:
    """That a parameter gets its value back, whatever rule has set it."""
    action = ActRequest(kind=ActionKind.SET_PARAMETER, target=parameter.node, parameter=parameter.name)
    return ActionDecision(t_s=0.0, stamp_ns=0, event=ActionEvent.END, action=action)


def _is_same(one: object, other: object) -> bool:
    """Whether they are one value to a node: NaN is like itself, and 1 is not 1.0."""
    return type(one) is type(other) and repr(one) == repr(other)


def _is_among(value: object, values: Iterable[object]) -> bool:
    return any(_is_same(value, one) for one in values)
