# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Counts on ``/count``, listens to what ``/testudo/count`` has of it, and has the rules reloaded meanwhile.

usage: echo_counter.py PATH '["begin … end", …]' N
N times, the file at PATH gets the next of the texts and ``~/reload`` is called, while numbers go on; after
every tenth, until one that was sent after the answer is back. At most a few messages are on the way, so that
no queue overflows however busy the machine is: a number that is missing was lost by somebody. Prints the
result: how many reloads succeeded, how many numbers came back, and those that did not follow the one before.
With N 0 it reloads nothing, says ``counting`` and goes on until a line comes on stdin.
"""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import rclpy
from std_msgs.msg import String
from std_srvs.srv import Trigger

AHEAD = 4


class Counter:
    def __init__(self) -> None:
        self.node = rclpy.create_node("counter")
        self.publisher = self.node.create_publisher(String, "/count", 10)
        self.node.create_subscription(String, "/testudo/count", self.hear, 10)
        self.client = self.node.create_client(Trigger, "/smarttestudo/reload")
        self.is_heard = False
        self.sent = self.heard = 0
        self.broken: list[int] = []

    def hear(self, message: String) -> None:
        number = int(message.data)
        self.is_heard = True
        if number:
            if number != self.heard + 1:
                self.broken.append(number)
            self.heard = number

    def count_until(self, is_done: Callable[[], bool]) -> None:
        while not is_done():
            while self.sent < self.heard + AHEAD:
                self.sent += 1
                self.publisher.publish(String(data=str(self.sent)))
            rclpy.spin_once(self.node, timeout_sec=0.1)

    def wait_for_listener(self) -> None:
        """0 is sent until it is back, for nobody hears what is sent before the relay is there."""
        while not (self.is_heard and self.client.service_is_ready()):
            self.publisher.publish(String(data="0"))
            rclpy.spin_once(self.node, timeout_sec=0.1)

    def reload(self, path: Path, text: str) -> bool:
        path.write_text(text, encoding="utf-8")
        answer = self.client.call_async(Trigger.Request())
        self.count_until(answer.done)
        return bool(answer.result().success)

    def count_until_told(self) -> None:
        told = threading.Event()

        def listen() -> None:
            sys.stdin.readline()
            told.set()

        threading.Thread(target=listen, daemon=True).start()
        sys.stdout.write("counting\n")
        self.count_until(told.is_set)

    def hear_what_is_sent_now(self) -> None:
        sent = self.sent
        self.count_until(lambda: self.heard > sent)
        sys.stdout.write(f"heard {self.heard}\n")


def main() -> None:
    path, texts, count = Path(sys.argv[1]), json.loads(sys.argv[2]), int(sys.argv[3])
    rclpy.init()
    counter = Counter()
    counter.wait_for_listener()
    succeeded = 0
    for number in range(count):
        succeeded += counter.reload(path, texts[number % len(texts)])
        if number % 10 == 9:
            counter.hear_what_is_sent_now()
    if not count:
        counter.count_until_told()
    result = {"succeeded": succeeded, "heard": counter.heard, "broken": counter.broken}
    sys.stdout.write(f"result {json.dumps(result)}\n")
    counter.node.destroy_node()
    rclpy.shutdown()


main()
