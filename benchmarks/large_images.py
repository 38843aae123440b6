# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Raw images through ``testudo run``, their camera with more shared memory and without.

Run it with ``python benchmarks/large_images.py [--seconds 10] [--domain 77] [--reliable] [--pixels 640x480]
[--hz 15]``. A camera process publishes numbered images, and an operator process notes which of them come out
of the relay, until they span the given time. The CPU is the runtime's, for each image that the camera sent.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import math
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any, NamedTuple

from live.contenders import TESTUDO
from live.processes import Process, environment

THINNED_HZ = 3.0
# How many times the span of a run an operator waits for it.
PATIENCE = 6
CHANNELS = 3
TOPIC = "/camera/image_raw"
# In CDR, the seconds of the stamp follow the four bytes of the encapsulation: here an image's number.
NUMBER_AT = slice(4, 8)


class Outcome(NamedTuple):
    """What an operator received of how many images, and what the runtime spent on each that was sent."""

    received_hz: float
    received: int
    sent: int
    cpu_ms: float


def qos(*, reliable: bool) -> Any:
    """A sensor's, or reliable."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy  # noqa: PLC0415  the parent needs no ROS

    policy = ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT
    return QoSProfile(depth=10, reliability=policy)


def be_camera(*, reliable: bool, pixels: str, hz: float) -> None:
    """Publish until terminated, then print how many."""
    import rclpy  # noqa: PLC0415
    from rclpy.serialization import serialize_message  # noqa: PLC0415
    from rclpy.signals import SignalHandlerOptions  # noqa: PLC0415
    from sensor_msgs.msg import Image  # noqa: PLC0415

    width, height = map(int, pixels.split("x"))
    image = Image(height=height, width=width, encoding="rgb8", step=width * CHANNELS)
    image.data = bytes(width * height * CHANNELS)
    payload = bytearray(serialize_message(image))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    stopped = threading.Event()
    signal.signal(signal.SIGTERM, lambda _number, _frame: stopped.set())
    publisher = rclpy.create_node("camera").create_publisher(Image, TOPIC, qos(reliable=reliable))
    due_s, number = time.monotonic(), 0
    while not stopped.is_set():
        number += 1
        payload[NUMBER_AT] = number.to_bytes(4, "little")
        publisher.publish(bytes(payload))
        # A camera that is late does not make up for it with a burst.
        due_s = max(due_s + 1 / hz, time.monotonic())
        time.sleep(max(0.0, due_s - time.monotonic()))
    print(number)


def be_operator(*, reliable: bool, seconds: float) -> None:
    """Print ``first`` with the first image, then number and arrival of each, until they span ``seconds``."""
    import rclpy  # noqa: PLC0415
    from sensor_msgs.msg import Image  # noqa: PLC0415

    arrivals: list[tuple[int, float]] = []

    def note(payload: bytes) -> None:
        if not arrivals:
            print("first", flush=True)
        arrivals.append((int.from_bytes(payload[NUMBER_AT], "little"), time.monotonic()))

    rclpy.init()
    node = rclpy.create_node("operator")
    node.create_subscription(Image, f"/testudo{TOPIC}", note, qos(reliable=reliable), raw=True)
    patience_s = time.monotonic() + PATIENCE * seconds
    while time.monotonic() < patience_s and (not arrivals or arrivals[-1][1] - arrivals[0][1] < seconds):
        rclpy.spin_once(node, timeout_sec=0.1)
    if not arrivals:
        print("none")
    print(json.dumps(arrivals), flush=True)


def measure(
    rate: str, of_others: dict[str, str], of_camera: dict[str, str], options: list[str], seconds: float
) -> Outcome:
    """One run of all three processes, of which the camera has variables of its own."""
    with tempfile.TemporaryDirectory() as folder:
        rules = Path(folder) / "rules.adirf"
        rules.write_text(f"begin SetFrequency {TOPIC} {rate} end", encoding="utf-8")
        commands = (
            [sys.executable, "-c", TESTUDO, "run", "--rules", str(rules)],
            [sys.executable, __file__, "--be", "operator", *options],
            [sys.executable, __file__, "--be", "camera", *options],
        )
        variables = (of_others, of_others, of_camera)
        runtime, operator, camera = map(Process, commands, variables)
        operator.line()
        cpu_s = runtime.cpu_s
        arrivals = json.loads(operator.line())
        cpu_s = runtime.cpu_s - cpu_s
        # Killed ones would leave their shared memory behind.
        sent = int(camera.end() or 0)
        operator.end()
        runtime.end()
    return outcome(arrivals, sent, cpu_s, seconds)


def outcome(arrivals: list[tuple[int, float]], sent: int, cpu_s: float, seconds: float) -> Outcome:
    """Of the images from the first that arrived: to the last, or to the end where too few came."""
    if not arrivals:
        return Outcome(received_hz=0.0, received=0, sent=sent, cpu_ms=math.nan)
    (first, first_s), (last, last_s) = arrivals[0], arrivals[-1]
    span_s = last_s - first_s
    sent = (last if span_s >= seconds else sent) - first + 1
    return Outcome(
        received_hz=(len(arrivals) - 1) / max(span_s, seconds),
        received=len(arrivals),
        sent=sent,
        cpu_ms=1000 * cpu_s / sent,
    )


def main() -> None:
    """Print a row for each transport and rate."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=10.0, help="of each run (default: %(default)s)")
    parser.add_argument("--domain", type=int, default=77, help="ROS domain that nobody else uses")
    parser.add_argument("--reliable", action="store_true", help="not the best effort of a sensor")
    parser.add_argument("--pixels", default="1920x1080", help="of an image (default: %(default)s)")
    parser.add_argument("--hz", type=float, default=29.0, help="of the camera (default: %(default)s)")
    parser.add_argument("--be", choices=["camera", "operator"], help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if importlib.util.find_spec("rclpy") is None:
        parser.exit(1, "this benchmark needs ROS 2 (rclpy)\n")
    if arguments.be == "camera":
        be_camera(reliable=arguments.reliable, pixels=arguments.pixels, hz=arguments.hz)
    elif arguments.be == "operator":
        be_operator(reliable=arguments.reliable, seconds=arguments.seconds)
    else:
        compare(arguments)


def compare(arguments: argparse.Namespace) -> None:
    """A camera with the shared memory of the default and with more, all images and few."""
    options = ["--seconds", str(arguments.seconds), "--pixels", arguments.pixels, "--hz", str(arguments.hz)]
    options += ["--reliable"] if arguments.reliable else []
    plain, large = (environment(arguments.domain, large_messages=is_large) for is_large in (False, True))
    print("| camera | rate asked | received, Hz | received of sent | CPU per image sent |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for name, of_camera in {"default": plain, "with the profile": large}.items():
        for rate in ("Full", f"{THINNED_HZ:g}"):
            one = measure(rate, plain, of_camera, options, arguments.seconds)
            received = f"{one.received} of {one.sent}"
            cpu = f"{one.cpu_ms:.1f} ms" if one.received else "–"
            print(f"| {name} | {rate} | {one.received_hz:.2f} | {received} | {cpu} |", flush=True)


if __name__ == "__main__":
    main()
