# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Notices reach an HTTP server in order, none is lost while it is away, and none comes twice without need."""

from __future__ import annotations

import json
import time

import pytest

from actions.http_servers import served, waited_for
from smarttestudo.actions.webhook import MOST_WAITING, Webhook, WebhookUrl


def hook(port: int, said: list[str]) -> Webhook:
    url = WebhookUrl.read(f"http://127.0.0.1:{port}/secret?token=x")
    return Webhook(url.host, url.post, said.append)


def test_a_real_server_gets_each_once_and_in_order() -> None:
    said: list[str] = []
    with served() as server, hook(server.server_port, said).running():
        pass
    with served() as server:
        webhook = hook(server.server_port, said)
        with webhook.running():
            for number in range(30):
                webhook.put({"id": number, "text": "\x1b[2J;$(rm)\u202e\n" + "x" * 100_000})
            assert waited_for(server, 30) == list(range(30))
    assert said == []


def test_a_real_server_that_is_away_for_a_while_gets_all_when_it_is_back() -> None:
    said: list[str] = []
    with served() as server:
        port = server.server_port
        webhook = hook(port, said)
        with webhook.running():
            webhook.put({"id": 0})
            assert waited_for(server, 1) == [0]
            server.shutdown()
            server.server_close()
            webhook.put({"id": 1})
            webhook.put({"id": 2})
            while not said:
                time.sleep(0.02)
            with served(port) as again:
                assert waited_for(again, 2) == [1, 2]
    assert said == [
        f"notices: http://127.0.0.1:{port} gives no answer (ConnectionRefusedError); they wait, 1000 at most",
        f"notices: http://127.0.0.1:{port} answers again",
    ]
    assert "secret" not in "".join(said)


def test_what_is_refused_is_said_and_not_repeated() -> None:
    said: list[str] = []
    with served(status=403) as server:
        webhook = hook(server.server_port, said)
        with webhook.running():
            webhook.put({"id": 0})
            webhook.put({"id": 1})
            assert waited_for(server, 2) == [0, 1]
    assert [line.rpartition(" refuses ")[2] for line in said] == ["one: it answers 403"] * 2


class VirtualServer:
    """A server in virtual time that is away from ``away_s`` to ``back_s``, or answers 503."""

    def __init__(self, away_s: float, back_s: float, *, answers: bool) -> None:
        self.now_s = 0.0
        self.away = away_s, back_s
        self.answers = answers
        self.got: list[object] = []
        self.tried = 0

    def post(self, data: bytes) -> int:
        self.tried += 1
        if self.away[0] <= self.now_s < self.away[1]:
            if self.answers:
                return 503
            raise ConnectionRefusedError
        self.got.append(json.loads(data)["id"])
        return 200

    def wait(self, seconds: float) -> bool:
        self.now_s += seconds
        return self.now_s > 1000


@pytest.mark.parametrize("answers", [False, True])
def test_none_is_lost_in_an_outage_of_60_s_and_it_is_tried_a_few_times(*, answers: bool) -> None:
    server = VirtualServer(0, 60, answers=answers)
    said: list[str] = []
    webhook = Webhook("http://x", server.post, said.append, wait=server.wait)
    for number in range(600):
        webhook.put({"id": number})
    with webhook.running():
        pass
    assert server.got == list(range(600))
    assert server.now_s < 80
    assert server.tried < 620


def test_of_more_than_can_wait_the_oldest_give_way_which_is_said() -> None:
    server = VirtualServer(0, 1e9, answers=False)
    said: list[str] = []
    webhook = Webhook("http://x", server.post, said.append, wait=server.wait)
    for number in range(MOST_WAITING + 7):
        webhook.put({"id": number})
    with webhook.running():
        pass
    assert server.got == []
    assert said[-1] == f"notices: {MOST_WAITING + 7} did not reach http://x"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "example.org",
        "ftp://x/",
        "http://",
        "http://u:p@x/",
        "http://x y/",
        "http://x/\r\nA: b",
        "http://[",
        "http://x:99999/",
        "http://é/",
    ],
)
def test_what_is_no_url_is_refused_without_repeating_it(text: str) -> None:
    with pytest.raises(ValueError, match=r"^it is written as in https://example\.org/notices"):
        WebhookUrl.read(text)
