# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bodies of requests: bounded, and of one type each."""

from __future__ import annotations

from typing import TypeVar

import msgspec
from starlette.requests import Request

from smarttestudo.ruler.server.errors import JSON, RequestError

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
