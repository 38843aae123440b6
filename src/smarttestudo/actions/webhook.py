# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Notices to an HTTP server, as JSON, from a thread of their own: in order, and again until they arrive."""

from __future__ import annotations

import http.client
import ssl
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple
from urllib.parse import SplitResult, urlsplit

from smarttestudo.domain.json_text import json_text

MOST_WAITING = 1000
"""How many notices wait for the server; the oldest give way then."""
_TIMEOUT_S = 10.0
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 1.0, 15.0
_LAST_S = 3.0
"""How long a run that ends waits for what it has not sent yet."""
_TRY_AGAIN = frozenset({408, 425, 429})

Body = dict[str, object]
Post = Callable[[bytes], int]
"""Sends a body; the status of the answer. Raises ``OSError`` or ``HTTPException`` where none came."""


class WebhookUrl(NamedTuple):
    """A URL of ``--notify``; only its host is ever said, for the rest may be a secret."""

    text: str
    parts: SplitResult

    @classmethod
    def read(cls, text: str) -> WebhookUrl:
        """The URL in ``text``. Raises ``ValueError`` that does not repeat it."""
        form = "it is written as in https://example.org/notices, without a user or a password"
        try:
            parts = urlsplit(text)
            is_known = parts.scheme in {"http", "https"} and bool(parts.hostname) and parts.port != 0
        except ValueError:
            raise ValueError(form) from None
        is_plain = text.isascii() and text.isprintable() and " " not in text
        if not is_known or not is_plain or parts.username is not None:
            raise ValueError(form)
        return cls(text, parts)

    @property
    def host(self) -> str:
        """Scheme, host and port."""
        return f"{self.parts.scheme}://{self.parts.netloc}"

    def post(self, body: bytes) -> int:
        """Send ``body``; the status of the answer."""
        host, port = self.parts.hostname or "", self.parts.port
        connection: http.client.HTTPConnection
        if self.parts.scheme == "https":
            connection = http.client.HTTPSConnection(
                host, port, timeout=_TIMEOUT_S, context=ssl.create_default_context()
            )
        else:
            connection = http.client.HTTPConnection(host, port, timeout=_TIMEOUT_S)
        target = (self.parts.path or "/") + (f"?{self.parts.query}" if self.parts.query else "")
        try:
            connection.request("POST", target, body, {"Content-Type": "application/json"})
            return connection.getresponse().status
        finally:
            connection.close()


class Webhook:
    """Posts notices by ``post``, one after the other. ``said`` is given a line where something goes wrong.

    A notice is sent again until an answer comes that the server has it, or will not have it. ``wait`` waits
    for so many seconds, or until the run ends, and says whether it does.
    """

    def __init__(
        self,
        host: str,
        post: Post,
        said: Callable[[str], None],
        *,
        wait: Callable[[float], bool] | None = None,
    ) -> None:
        self._host = host
        self._post = post
        self._said = said
        self._waiting: deque[Body] = deque()
        self._changed = threading.Condition()
        self._ended = threading.Event()
        self._wait = self._ended.wait if wait is None else wait
        self._dropped = 0

    def put(self, body: Body) -> None:
        """Send ``body`` once all before it is sent."""
        with self._changed:
            self._waiting.append(body)
            if len(self._waiting) > MOST_WAITING:
                self._waiting.popleft()
                self._dropped += 1
            self._changed.notify()

    @contextmanager
    def running(self) -> Iterator[None]:
        """Send during the block, and for a short time after it what is left."""
        thread = threading.Thread(target=self.deliver, name="notices", daemon=True)
        thread.start()
        try:
            yield
        finally:
            with self._changed:
                self._ended.set()
                self._changed.notify()
            thread.join(_LAST_S)
            left = len(self._waiting)
            if left or self._dropped:
                self._said(f"notices: {left + self._dropped} did not reach {self._host}")

    def deliver(self) -> None:
        """Send what comes, until the run ends and nothing is left or no answer comes."""
        while True:
            with self._changed:
                while not self._waiting:
                    if self._ended.is_set():
                        return
                    self._changed.wait()
                body = self._waiting[0]
            if not self._sent(body):
                return
            with self._changed:
                # The oldest may have given way meanwhile.
                if self._waiting and self._waiting[0] is body:
                    self._waiting.popleft()

    def _sent(self, body: Body) -> bool:
        """Whether the server has ``body``, or said that it will not."""
        data = json_text(body).encode("ascii")
        pause_s, has_said = _FIRST_PAUSE_S, False
        while True:
            problem = self._problem(data)
            if problem is None:
                if has_said:
                    self._said(f"notices: {self._host} answers again")
                return True
            if not has_said:
                self._said(f"notices: {self._host} {problem}; they wait, {MOST_WAITING} at most")
                has_said = True
            if self._wait(pause_s):
                return False
            pause_s = min(2 * pause_s, _LONGEST_PAUSE_S)

    def _problem(self, data: bytes) -> str | None:
        """Why ``data`` has to be sent again, if it has."""
        try:
            status = self._post(data)
        except (OSError, http.client.HTTPException) as error:
            return f"gives no answer ({type(error).__name__})"
        if status in _TRY_AGAIN or status >= 500:
            return f"answers {status}"
        if not 200 <= status < 300:
            self._said(f"notices: {self._host} refuses one: it answers {status}")
        return None
