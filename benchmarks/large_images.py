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
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

PROFILE = (
    Path(__file__).resolve().parent.parent
    / "src" / "smarttestudo" / "robot" / "ros" / "fastdds_large_messages.xml"
)  # fmt: skip
THINNED_HZ = 3.0
# How many times the span of a run an operator waits for it.
PATIENCE = 6
CHANNELS = 3
TOPIC = "/camera/image_raw"
# In CDR, the seconds of the stamp follow the four bytes of the encapsulation: here an image's number.
NUMBER_AT = slice(4, 8)
TESTUDO = "import sys; from smarttestudo.cli.main import main; sys.exit(main())"


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
    rate: str,
    environment: Mapping[str, str],
    of_camera: Mapping[str, str],
    options: list[str],
    seconds: float,
) -> Outcome:
    """One run of all three processes, of which the camera has further variables."""
    with tempfile.TemporaryDirectory() as folder:
        rules = Path(folder) / "rules.adirf"
        rules.write_text(f"begin SetFrequency {TOPIC} {rate} end", encoding="utf-8")
        runtime = start(environment, "-c", TESTUDO, "run", "--rules", str(rules))
        operator = start(environment, __file__, "--be", "operator", *options)
        camera = start({**environment, **of_camera}, __file__, "--be", "camera", *options)
        assert operator.stdout is not None
        operator.stdout.readline()
        cpu_s = cpu_of(runtime)
        arrivals = json.loads(operator.stdout.readline())
        cpu_s = cpu_of(runtime) - cpu_s
        # Killed ones would leave their shared memory behind.
        for process in (runtime, operator, camera):
            process.terminate()
        sent, _, _ = (int(process.communicate()[0] or 0) for process in (camera, operator, runtime))
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


def start(environment: Mapping[str, str], *arguments: str) -> subprocess.Popen[str]:
    """A process of this environment."""
    return subprocess.Popen(
        [sys.executable, *arguments],
        env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip


def cpu_of(process: subprocess.Popen[str]) -> float:
    """The seconds of CPU that a process has used so far."""
    fields = Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


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
    base = {
        **os.environ,
        "ROS_DOMAIN_ID": str(arguments.domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    profile = {"FASTDDS_DEFAULT_PROFILES_FILE": str(PROFILE), "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE)}
    print("| camera | rate asked | received, Hz | received of sent | CPU per image sent |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for name, extra in {"default": {}, "with the profile": profile}.items():
        for rate in ("Full", f"{THINNED_HZ:g}"):
            one = measure(rate, base, extra, options, arguments.seconds)
            received = f"{one.received} of {one.sent}"
            cpu = f"{one.cpu_ms:.1f} ms" if one.received else "–"
            print(f"| {name} | {rate} | {one.received_hz:.2f} | {received} | {cpu} |", flush=True)


if __name__ == "__main__":
    main()
