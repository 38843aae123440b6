# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Routes of the jobs: requests as structs, and answers as JSON, pictures and files."""

from __future__ import annotations

import asyncio
import gzip
import hashlib
import re
from collections import ChainMap
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from inspect import iscoroutinefunction
from typing import Any, TypeVar

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route
from starlette.types import Scope

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.job import (
    Download,
    Job,
    Permission,
    Picture,
    Pieces,
    Report,
    RequestError,
    answer_json,
)
from smarttestudo.ruler.problem import ErrorAnswer, problem_of

JSON = "application/json"
_BYTES, _PNG, _ZIP = "application/octet-stream", "image/png", "application/zip"
GONE = 499
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


_PERMISSION = "testudo.permission"


def note_permission(scope: Scope, permission: Permission) -> None:
    """Keep what the sender of a request may do with the request."""
    scope[_PERMISSION] = permission


def noted_permission(scope: Scope) -> Permission:
    """Permission that was noted for the sender of a request."""
    permission: Permission = scope[_PERMISSION]
    return permission


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


_Run = Callable[[msgspec.Struct, Report], Awaitable[bytes]]
"""Does a job in a process of its own; ``TestudoError`` where that has no answer."""
_Tell = Callable[[str, float], None]


def job_route(job: Job[..., Any], services: Mapping[Any, object], run: _Run, tell: _Tell) -> Route:
    """The route of ``job``, with what its parameters need of ``services`` and of the request.

    ``run`` does it in a process, if it has a limit; ``tell`` is told how far that is, by the page's name of
    it.
    """
    asked, needs = job.asked, job.needs

    async def handle(request: Request) -> Response:
        body = None if asked is None else await read_body(request, asked)
        if job.limit is not None and body is not None:
            done = await _while_asked(request, _in_process(job, body, run, tell))
            return await run_in_threadpool(json_answer, request, done)
        given = ChainMap({asked: body, Permission: noted_permission(request.scope)}, dict(services))
        if Pieces in needs.values():
            given[Pieces] = _pieces(request)
        arguments = {
            name: given[kind] if kind in given else _from_query(request, name, kind)
            for name, kind in needs.items()
        }
        if iscoroutinefunction(job.do):
            return _response(request, await job(**arguments))
        return await run_in_threadpool(lambda: _response(request, job(**arguments)))

    return Route(job.path, handle, methods=[job.method])


async def _in_process(job: Job[..., Any], body: msgspec.Struct, run: _Run, tell: _Tell) -> bytes:
    name = getattr(body, "run", "")
    try:
        return await run(body, lambda share: tell(name, share))
    except TestudoError as error:
        if job.failed is None:
            raise
        return answer_json(job.failed(error))


async def _while_asked(request: Request, work: Coroutine[Any, Any, bytes]) -> bytes:
    """The result of ``work``, which is cancelled once the page that asked has gone."""
    doing, leaving = asyncio.ensure_future(work), asyncio.ensure_future(_left(request))
    try:
        await asyncio.wait({doing, leaving}, return_when=asyncio.FIRST_COMPLETED)
        if doing.done():
            return doing.result()
        raise RequestError("the page was closed", GONE)
    finally:
        for one in (doing, leaving):
            one.cancel()
        await asyncio.gather(doing, leaving, return_exceptions=True)


async def _left(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _from_query(request: Request, name: str, kind: Any) -> object:
    """A text of the address, empty where it is missing; ``RequestError`` for one that is no ``kind``."""
    try:
        return msgspec.convert(request.query_params.get(name, ""), type=kind)
    except msgspec.ValidationError as error:
        raise RequestError(f"the request is not understood: {error}", 400) from error


def _pieces(request: Request) -> Pieces:
    # Only a page of this server can send this type, and a form of another site cannot.
    if request.headers.get("content-type") != _BYTES:
        raise RequestError("the body must be a file", _WRONG_TYPE, remedy=f"send Content-Type: {_BYTES}")
    return request.stream()


def _response(request: Request, answer: object) -> Response:
    match answer:
        case bytes():
            return Response(answer, media_type=_PNG)
        case Picture():
            headers = {"Cache-Control": "private, max-age=3600, immutable"}
            return Response(answer.content, media_type=answer.media_type, headers=headers)
        case Download():
            # The name has neither quotes nor slashes. Where a file cannot be read, the answer breaks off.
            headers = {"Content-Disposition": f'attachment; filename="{answer.name}.zip"'}
            return StreamingResponse(answer.pieces, media_type=_ZIP, headers=headers)
        case _:
            return json_answer(request, answer_json(answer))


def error_answer(error: TestudoError, shown: Callable[[str], str] = str) -> Response:
    """The response for ``error``; ``shown`` is a place as the project calls it."""
    status, problem = problem_of(error, shown)
    return Response(msgspec.json.encode(ErrorAnswer(error=problem)), status, media_type=JSON)
