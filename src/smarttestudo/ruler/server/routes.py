# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Routes that know what they are asked and what they answer."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TypeVar, get_type_hints

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from smarttestudo.ruler.answer_json import answer_json
from smarttestudo.ruler.server.bodies import read_body
from smarttestudo.ruler.server.encodings import json_answer
from smarttestudo.ruler.server.permission import Permission, noted_permission

Handler = Callable[[Request], Awaitable[Response]]
_Body = TypeVar("_Body", bound=msgspec.Struct)


class ApiRoute(Route):
    """A route whose body is ``asked``, or none, and whose answer is ``answered``."""

    def __init__(
        self,
        method: str,
        path: str,
        handle: Handler,
        *,
        asked: type[msgspec.Struct] | None,
        answered: type,
    ) -> None:
        super().__init__(path, handle, methods=[method])
        self.method, self.asked, self.answered = method, asked, answered


def answering(
    path: str,
    asked: type[_Body],
    answer: Callable[[_Body], object],
    *,
    method: str = "POST",
    answered: Callable[[_Body], None] | None = None,
) -> ApiRoute:
    """Decodes the body, calls ``answer`` and encodes what it returns.

    ``answered`` is called after it, if who asked may change something.
    """

    async def handle(request: Request) -> Response:
        body = await read_body(request, asked)

        def done() -> Response:
            response = json_answer(request, answer_json(answer(body)))
            if answered is not None and noted_permission(request.scope) is Permission.CHANGE:
                answered(body)
            return response

        return await run_in_threadpool(done)

    return ApiRoute(method, path, handle, asked=asked, answered=_returned(answer))


def long_work(
    path: str,
    asked: type[_Body],
    answer: Callable[[Request, _Body], Awaitable[Response]],
    answered: type,
) -> ApiRoute:
    """Decodes the body; ``answer`` sees the request, to end its work with who asked for it."""

    async def handle(request: Request) -> Response:
        return await answer(request, await read_body(request, asked))

    return ApiRoute("POST", path, handle, asked=asked, answered=answered)


def telling(path: str, answer: Callable[..., object], *, query: str | None = None) -> ApiRoute:
    """A GET without a body; ``answer`` is called with ``query`` of the address, if that has a name."""

    async def handle(request: Request) -> Response:
        given = () if query is None else (request.query_params.get(query, ""),)
        return await run_in_threadpool(lambda: json_answer(request, answer_json(answer(*given))))

    return ApiRoute("GET", path, handle, asked=None, answered=_returned(answer))


def _returned(answer: Callable[..., object]) -> type:
    kind: type = get_type_hints(answer)["return"]
    return kind
