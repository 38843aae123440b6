# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Requests as structs, and answers as JSON."""

from __future__ import annotations

import gzip
import hashlib
import re
from collections.abc import Awaitable, Callable
from typing import TypeVar, get_type_hints

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from smarttestudo.ruler.answer_json import answer_json
from smarttestudo.ruler.server.errors import JSON, RequestError
from smarttestudo.ruler.server.guard import Permission, noted_permission

_LEAST_BYTES = 1000
_LEVEL = 5
_TAG_BYTES = 12
_NOT_MODIFIED = 304
_ASK_AGAIN = "private, no-cache"
_NEVER = re.compile(r"q=0(\.0*)?")


def taken_encodings(accepted: str) -> frozenset[str]:
    """The encodings that an ``Accept-Encoding`` allows."""
    parts = (each.strip().lower().partition(";") for each in accepted.split(","))
    return frozenset(name.strip() for name, _, weight in parts if not _NEVER.fullmatch(weight.strip()))


def json_answer(request: Request, body: bytes) -> Response:
    """JSON, compressed where that is worth it and the browser takes it; what it has of a GET is not sent."""
    headers = {"Vary": "Accept-Encoding"}
    if request.method == "GET":
        headers |= {"ETag": _tag(body), "Cache-Control": _ASK_AGAIN}
        if request.headers.get("if-none-match") == headers["ETag"]:
            return Response(status_code=_NOT_MODIFIED, headers=headers)
    if len(body) < _LEAST_BYTES or "gzip" not in taken_encodings(request.headers.get("accept-encoding", "")):
        return Response(body, media_type=JSON, headers=headers)
    packed = gzip.compress(body, _LEVEL, mtime=0)
    return Response(packed, media_type=JSON, headers={**headers, "Content-Encoding": "gzip"})


def _tag(body: bytes) -> str:
    """A weak tag, for the compressed answer has the same."""
    return f'W/"{hashlib.blake2b(body, digest_size=_TAG_BYTES).hexdigest()}"'


MAX_BODY_BYTES = 2_000_000
_TOO_LARGE = 413
_WRONG_TYPE = 415
_Body = TypeVar("_Body", bound=msgspec.Struct)


async def read_body(request: Request, kind: type[_Body]) -> _Body:
    """The body as ``kind``.

    Raises ``RequestError`` for one that is declared or turns out larger than 2 MB, is no JSON or is none of
    ``kind``.
    """
    if request.headers.get("content-type", "").partition(";")[0].strip() != JSON:
        raise RequestError("the body must be JSON", _WRONG_TYPE, remedy=f"send Content-Type: {JSON}")
    data = await _bounded(request)
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RequestError(f"the request is not understood: {error}", 400) from error
    except RecursionError as error:
        raise RequestError("the request nests too deep", 400) from error


def read_query(request: Request, kind: type[_Body]) -> _Body:
    """The query as ``kind``; what is missing in it is empty. Raises ``RequestError`` for one that is none."""
    query = {name: request.query_params.get(name, "") for name in kind.__struct_fields__}
    try:
        return msgspec.convert(query, type=kind)
    except msgspec.ValidationError as error:
        raise RequestError(f"the request is not understood: {error}", 400) from error


async def _bounded(request: Request) -> bytes:
    declared = request.headers.get("content-length", "0")
    if not declared.isdecimal() or int(declared) > MAX_BODY_BYTES:
        raise _too_large()
    chunks = bytearray()
    async for chunk in request.stream():
        chunks += chunk
        if len(chunks) > MAX_BODY_BYTES:
            raise _too_large()
    return bytes(chunks)


def _too_large() -> RequestError:
    return RequestError("the body is larger than 2 MB", _TOO_LARGE, remedy="split the rule file")


Handler = Callable[[Request], Awaitable[Response]]


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
