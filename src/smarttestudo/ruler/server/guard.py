# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Guard of the server: only pages that it served talk to it, on names of its own, with a token of it.

A page of another site can send requests to 127.0.0.1 from the user's browser, also under a name of its own
that it makes point there (DNS rebinding); it can set neither ``Host`` nor ``Origin``.
"""

from __future__ import annotations

import secrets
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from urllib.parse import parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocketClose

from smarttestudo.ruler.job import Permission, RequestError
from smarttestudo.ruler.server.page import token_page
from smarttestudo.ruler.server.routes import error_answer, note_permission

_FORBIDDEN, _UNAUTHORIZED = 403, 401
_POLICY_VIOLATION = 1008
_READING = frozenset(("GET", "HEAD", "OPTIONS"))
_DEFAULT_PORT = 80
POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        # Blockly puts its style sheets into the page as <style> elements.
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self'",
        "connect-src 'self'",
        "manifest-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
SECURITY_HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerAddress:
    """How the server is called: its address, all its names, and the token that it asks for, if any.

    Who has ``watch_token`` may only watch, and with ``is_watch_only`` everybody.
    """

    host: str
    port: int
    names: frozenset[str] = frozenset()
    token: str | None = field(default=None, repr=False)
    watch_token: str | None = field(default=None, repr=False)
    is_watch_only: bool = False

    @staticmethod
    def at(host: str, port: int, *, machine: str = "localhost", is_watch_only: bool = False) -> ServerAddress:
        """The address on ``host`` of the computer ``machine``; others, if they can reach it, need a token."""
        token = None if is_loopback(host) else secrets.token_urlsafe(32)
        watch_token = None if token is None or is_watch_only else secrets.token_urlsafe(32)
        names = frozenset(name.lower() for name in (host, machine, f"{machine}.local"))
        # 0.0.0.0 is every address of this computer, and none that a browser can open.
        shown = machine if _is_every_address(host) else host
        return ServerAddress(
            host=shown,
            port=port,
            names=names,
            token=token,
            watch_token=watch_token,
            is_watch_only=is_watch_only,
        )

    @property
    def url(self) -> str:
        """The address to open."""
        return self._url(self.token)

    @property
    def watch_url(self) -> str | None:
        """The address for whom is to watch only; ``None`` where there is no other than ``url``."""
        return None if self.watch_token is None else self._url(self.watch_token)

    def _url(self, token: str | None) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        query = f"?token={token}" if token else ""
        return f"http://{host}:{self.port}/{query}"

    @property
    def cookie(self) -> str:
        """The cookie's name; cookies of one host are shared by all its ports."""
        return f"testudo_ruler_{self.port}"

    def allows_host(self, host: str | None) -> bool:
        """Whether ``Host`` names this server. Any name can be made to point here, an address cannot."""
        name, port = _split(host or "")
        if name is None or port != self.port:
            return False
        if self.token is None:
            return name == "localhost" or is_loopback(name)
        return name in self.names or name == "localhost" or _is_address(name)

    def allows_origin(self, origin: str | None, host: str | None) -> bool:
        """Whether ``Origin`` is the page that ``host`` itself served."""
        return origin is not None and origin.lower() == f"http://{host}".lower()

    def permission_of(self, token: str | None) -> Permission | None:
        """Permission of who sends ``token``; ``None`` where that is no token that was printed."""
        if self.token is None or _is_same(token, self.token):
            return Permission.WATCH if self.is_watch_only else Permission.CHANGE
        return Permission.WATCH if _is_same(token, self.watch_token) else None


class Guard:
    """Lets nothing through to ``app`` that ``access`` does not allow, and marks every answer.

    Who only watches may ask what ``reading`` routes answer, which change neither a file nor a robot.
    """

    def __init__(self, app: ASGIApp, access: ServerAddress, reading: Collection[str]) -> None:
        self._app = app
        self._access = access
        self._reading = frozenset(reading)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or close, what is not allowed."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        if scope["type"] == "websocket":
            allowed = refusal is None
            await (self._app if allowed else WebSocketClose(_POLICY_VIOLATION))(scope, receive, send)
            return
        marked = _marked(send)
        if refusal is not None:
            is_read = refusal.status == _UNAUTHORIZED and _is_shown(scope)
            answer = token_page(_UNAUTHORIZED) if is_read else error_answer(refusal)
            await answer(scope, receive, marked)
        elif (token := _token_in(scope)) is not None and self._access.token is not None:
            await self._give_cookie(token)(scope, receive, marked)
        else:
            await self._app(scope, receive, marked)

    def _refusal(self, scope: Scope) -> RequestError | None:
        headers, access = Headers(scope=scope), self._access
        if not access.allows_host(headers.get("host")):
            return RequestError(
                "the request is for another host name", _FORBIDDEN, remedy=f"open {access.host}"
            )
        origin = headers.get("origin")
        must_have_origin = scope["type"] == "websocket"
        if (origin is not None or must_have_origin) and not access.allows_origin(origin, headers.get("host")):
            return RequestError("the request comes from another site's page", _FORBIDDEN)
        if headers.get("sec-fetch-site", "none") not in ("none", "same-origin") and _is_api(scope):
            return RequestError("the request comes from another site's page", _FORBIDDEN)
        may = access.permission_of(_token_in(scope) or _cookie_in(headers, access.cookie))
        if may is None:
            remedy = "open the address with the token that testudo ruler printed"
            return RequestError("the token is missing or wrong", _UNAUTHORIZED, remedy=remedy)
        note_permission(scope, may)
        if may is Permission.WATCH and _is_api(scope) and not self._only_reads(scope):
            return RequestError(
                "you may only watch here: nothing was changed",
                _FORBIDDEN,
                remedy="ask whoever started testudo ruler for the address that may change things",
            )
        return None

    def _only_reads(self, scope: Scope) -> bool:
        """Whether a request changes neither a file nor a robot, whatever its body says."""
        if scope["type"] == "websocket" or scope["method"] in _READING:
            return True
        return f"{scope['method']} {scope['path']}" in self._reading

    def _give_cookie(self, token: str) -> RedirectResponse:
        """Keep the token in a cookie, and out of the address."""
        answer = RedirectResponse("/", status_code=303)
        # A strict cookie is not sent by who clicks a link in a mail or a chat; Origin keeps other sites out.
        answer.set_cookie(self._access.cookie, token, httponly=True, samesite="lax")
        return answer


def _is_same(token: str | None, printed: str | None) -> bool:
    if token is None or printed is None:
        return False
    return secrets.compare_digest(token.encode(), printed.encode())


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach ``host``."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _is_address(name: str) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return False
    return True


def _is_every_address(name: str) -> bool:
    return _is_address(name) and ip_address(name).is_unspecified


def _split(host: str) -> tuple[str | None, int]:
    try:
        parts = urlsplit(f"//{host}")
        port = parts.port
    except ValueError:
        return None, 0
    is_plain = parts.netloc == host and "@" not in host
    return (parts.hostname if is_plain else None), port or _DEFAULT_PORT


def _is_api(scope: Scope) -> bool:
    return str(scope["path"]).startswith("/api/") or scope["type"] == "websocket"


def _is_shown(scope: Scope) -> bool:
    """Whether a person is to read the answer, and no script."""
    return not _is_api(scope) and "text/html" in Headers(scope=scope).get("accept", "")


def _token_in(scope: Scope) -> str | None:
    """The token in the address of the first page."""
    if scope["type"] != "http" or scope["path"] != "/":
        return None
    query = parse_qs(scope["query_string"].decode("latin-1"))
    return next(iter(query.get("token", ())), None)


def _cookie_in(headers: Headers, name: str) -> str | None:
    try:
        cookie = SimpleCookie(headers.get("cookie", ""))
    except CookieError:
        return None
    return str(cookie[name].value) if name in cookie else None


def _marked(send: Send) -> Send:
    async def mark(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in SECURITY_HEADERS.items():
                headers[name] = value
            headers.setdefault("Cache-Control", "no-store")
        await send(message)

    return mark
