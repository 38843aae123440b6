# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Requests to services of other nodes: nothing waits for them, and none waits for ever."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from rclpy.exceptions import NameValidationException

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.parameter import SilentNodeError
from smarttestudo.domain.robot import Called, ServiceAnswer
from smarttestudo.robot.ros.ros_errors import ros_errors

REMOTE_POLL_PERIOD_S = 0.05
ANSWER_WITHIN_S = 5.0
# Clients of a service that is not used any more are kept no longer than this.
_KEPT_S = 60.0
_SETTLES_S = 0.25
_REPEAT_S = 1.0


@dataclass(slots=True)
class _Client:
    handle: Any
    used_s: float
    ready_s: float | None = None


@dataclass(slots=True, eq=False)
class _Request:
    """A request, with a future for each time that it was sent; the first answer counts.

    ``answered`` takes the response or the error. One with a ``repeat_s`` is sent again then.
    """

    client: _Client
    content: Any
    answered: Callable[[Any], None]
    place: str
    remedy: str | None
    until_s: float
    is_repeated: bool
    repeat_s: float = math.inf
    futures: list[Any] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class _Call:
    """A call of a service that may not be known yet."""

    service: str
    argument: bool | None
    called: Called
    until_s: float


class ServiceClients:
    """Clients of ``node``, on the thread of its executor.

    ``poll`` is to be called often: it sends what waits for a service to be found, and gives up in time.
    """

    def __init__(self, node: Any, steady_s: Callable[[], float]) -> None:
        self._node = node
        self._steady_s = steady_s
        self._clients: dict[tuple[str, Any], _Client] = {}
        self._requests: list[_Request] = []
        self._calls: list[_Call] = []

    def request(
        self,
        kind: Any,
        service: str,
        content: Any,
        answered: Callable[[Any], None],
        *,
        place: str,
        remedy: str | None = None,
        is_repeated: bool = False,
    ) -> None:
        """Ask ``service``, which is of ``kind``; ``answered`` is given the response or a ``RosError``, once.

        ``place`` and ``remedy`` are those of the error where nothing answers. One that ``is_repeated`` is
        sent again each second: on a busy machine, answers on Kilted were lost.
        """
        now_s = self._steady_s()
        client = self._clients.get((service, kind))
        try:
            if client is None:
                client = self._clients[service, kind] = self._new_client(kind, service, now_s)
        except RosError as error:
            answered(error)
            return
        client.used_s = now_s
        until_s = now_s + ANSWER_WITHIN_S
        self._requests.append(_Request(client, content, answered, place, remedy, until_s, is_repeated))
        self.poll()

    def call(self, service: str, *, argument: bool | None, called: Called) -> None:
        """Call a service of std_srvs, whose type is that on the graph, once it is there."""
        self._calls.append(_Call(service, argument, called, self._steady_s() + ANSWER_WITHIN_S))
        self.poll()

    def poll(self) -> None:
        """Send what can be sent, and give up on what took too long."""
        now_s = self._steady_s()
        for call in [*self._calls]:
            self._begin(call, now_s)
        for request in [*self._requests]:
            if now_s >= request.until_s:
                self._give_up(request)
            elif now_s >= request.repeat_s or (not request.futures and _is_settled(request.client, now_s)):
                self._send(request, now_s)
        busy = [request.client for request in self._requests]
        for key, client in [*self._clients.items()]:
            if client.used_s + _KEPT_S < now_s and client not in busy:
                del self._clients[key]
                self._node.destroy_client(client.handle)

    def _begin(self, call: _Call, now_s: float) -> None:
        """Make a request of ``call`` if its service is known by now, and give up in time."""
        kind: Any = None
        problem = RosError("no node offers this service", place=call.service)
        try:
            kind = self._kind(call)
        except RosError as error:
            problem, now_s = error, call.until_s
        if kind is None and now_s < call.until_s:
            return
        self._calls.remove(call)
        if kind is None:
            call.called(problem)
            return
        content = kind.Request() if call.argument is None else kind.Request(data=call.argument)

        def answered(response: Any) -> None:
            if isinstance(response, RosError):
                call.called(response)
                return
            is_success, message = getattr(response, "success", True), getattr(response, "message", "")
            call.called(ServiceAnswer(is_success=is_success, message=message))

        self.request(kind, call.service, content, answered, place=call.service)

    def _kind(self, call: _Call) -> Any:
        """The type of the service; ``None`` while there is none. Raises ``RosError`` for another."""
        with ros_errors(call.service):
            types = dict(self._node.get_service_names_and_types()).get(call.service, ())
        if not types:
            return None
        kinds = _kinds(call.service)
        kind = next((kinds[name] for name in types if name in kinds), None)
        if kind is None:
            cause = f"its type is {types[0]}, and not one of {', '.join(kinds)}"
            raise RosError(cause, place=call.service)
        if (call.argument is not None) is not hasattr(kind.Request(), "data"):
            remedy = "write true or false behind it" if call.argument is None else "write nothing behind it"
            raise RosError(f"its type is {types[0]}: {remedy}", place=call.service)
        return kind

    def _new_client(self, kind: Any, service: str, now_s: float) -> _Client:
        with ros_errors(service):
            try:
                return _Client(self._node.create_client(kind, service), now_s)
            except NameValidationException as error:
                raise RosError("this is not the name of a node or a service", place=service) from error

    def _send(self, request: _Request, now_s: float) -> None:
        if request.is_repeated:
            request.repeat_s = now_s + _REPEAT_S
        future = request.client.handle.call_async(request.content)
        request.futures.append(future)
        future.add_done_callback(partial(self._done, request))

    def _done(self, request: _Request, future: Any) -> None:
        if request not in self._requests:
            return
        self._close(request)
        error = future.exception()
        response = future.result() if error is None else RosError(str(error), place=request.place)
        request.answered(response)

    def _close(self, request: _Request) -> None:
        self._requests.remove(request)
        for future in request.futures:
            request.client.handle.remove_pending_request(future)

    def _give_up(self, request: _Request) -> None:
        self._close(request)
        request.answered(
            SilentNodeError(
                f"the node did not answer within {ANSWER_WITHIN_S:g} s",
                place=request.place,
                remedy=request.remedy,
            )
        )


def _is_settled(client: _Client, now_s: float) -> bool:
    """Whether the service is there, and has been for long enough to know of the client, too.

    The middleware drops the answer to one that it does not know yet.
    """
    if not client.handle.service_is_ready():
        client.ready_s = None
    elif client.ready_s is None:
        client.ready_s = now_s
    return client.ready_s is not None and now_s >= client.ready_s + _SETTLES_S


def _kinds(service: str) -> Mapping[str, Any]:
    """The services that can be called, by the names of their types. Raises ``RosError``."""
    try:
        from std_srvs.srv import Empty, SetBool, Trigger  # noqa: PLC0415  a robot may lack it
    except ImportError as error:
        remedy = "install the ROS package std_srvs"
        raise RosError("the types of services are not installed", place=service, remedy=remedy) from error
    return {"std_srvs/srv/Trigger": Trigger, "std_srvs/srv/SetBool": SetBool, "std_srvs/srv/Empty": Empty}
