# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said of command lines that make no link."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from link.zenoh.ends import free_endpoint
from smarttestudo.cli.main import main

RUN = ["run", "--rules", "rules.adirf"]


def refusal(capsys: pytest.CaptureFixture[str], arguments: list[str], code: int) -> str:
    """The one line that is said, and that nothing else is."""
    assert main(arguments) == code
    printed = capsys.readouterr()
    assert printed.out == ""
    (line,) = printed.err.splitlines()
    return line


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ([*RUN, option, *value], f"{option}: error: it needs a link; add --link or --link-listen")
        for option, *value in (
            ("--robot", "x"),
            ("--insecure",),
            ("--zenoh-config", "link.json5"),
            ("--fetch-budget", "0"),
        )
    ]
    + [
        (
            ["receive", "--no-ros"],
            "--no-ros: error: messages that arrive would go nowhere; "
            "add --record DIR, --incidents DIR, --catch-up DIR, --foxglove PORT or --openmetrics PORT",
        )
    ],
)
def test_options_that_lack_another_are_a_wrong_usage(
    capsys: pytest.CaptureFixture[str], arguments: list[str], line: str
) -> None:
    assert refusal(capsys, arguments, 2) == line


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["receive", "--no-ros", "--foxglove", "0", "--send", "/joy"],
            "--send: error: it sends messages of the ROS graph here; leave out --no-ros",
        ),
        (
            ["receive", "--no-ros", "--record", "new", "--predict", "/odom"],
            "--predict: error: predicted messages are shown, not recorded; "
            "leave out --no-ros, or add --foxglove PORT",
        ),
        (
            ["receive", "--predict", "odom"],
            "--predict: error: 'odom' is not the full name of a topic; write it as in /odom",
        ),
        ([*RUN, "--accept", "/joy"], "--accept: error: it needs a link; add --link or --link-listen"),
        (
            [*RUN, "--link", "tcp/127.0.0.1:7447", "--accept", "joy"],
            "--accept: error: 'joy' is not the full name of a topic; write it as in /joy",
        ),
        (
            [*RUN, "--link", "tcp/127.0.0.1:7447", "--accept", *(f"/joy{n}" for n in range(17))],
            "--accept: error: 17 topics are too many; name at most 16",
        ),
        (
            [*RUN, "--link", "tcp/192.0.2.1:7447", "--insecure", "--accept", "/joy", "/goal_pose"],
            "tcp/192.0.2.1:7447: error: whoever reaches it could drive the robot with /joy /goal_pose; "
            "protect it with --zenoh-config FILE, not --insecure, or leave out --accept and --send",
        ),
    ],
)
def test_what_drives_a_robot_needs_ros_full_names_and_a_link_that_lets_nobody_in(
    capsys: pytest.CaptureFixture[str], arguments: list[str], line: str
) -> None:
    assert refusal(capsys, arguments, 2) == line


def test_a_name_that_no_robot_can_have_is_a_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    line = refusal(capsys, [*RUN, "--link", free_endpoint(), "--robot", "a/b"], 2)
    assert line.startswith("--robot: error: 'a/b' cannot be a robot's name on a link; ")


WITHOUT_PORT = [
    ("tcp/127.0.0.1:99999", "'99999' is not a port from 0 to 65535; write it as in tls/192.168.1.5:7447"),
    ("udp/[::1]:http", "'http' is not a port"),
    ("tls/robot.local", "it has no port; write it as in tls/192.168.1.5:7447"),
]


@pytest.mark.parametrize(("endpoint", "remedy"), WITHOUT_PORT)
def test_who_only_watches_is_told_of_a_wrong_port_in_the_same_words(
    capsys: pytest.CaptureFixture[str], endpoint: str, remedy: str
) -> None:
    line = refusal(capsys, ["top", "--once", "--connect", endpoint], 1)
    assert line.startswith(f"{endpoint}: error: {remedy}")


@pytest.mark.parametrize("side", ["--link", "--link-listen"])
@pytest.mark.parametrize(
    ("endpoint", "remedy"),
    [
        ("nonsense", "tls/192.168.1.5:7447"),
        ("tcp/192.0.2.1:7447", "--insecure"),
        ("tcp/0.0.0.0:0", "--insecure"),
        *WITHOUT_PORT,
    ],
)
def test_a_robot_s_endpoint_that_cannot_be_used_is_said_in_one_line(
    capsys: pytest.CaptureFixture[str], side: str, endpoint: str, remedy: str
) -> None:
    line = refusal(capsys, [*RUN, side, endpoint], 1)
    assert line.startswith(f"{endpoint}: error: ")
    assert remedy in line


@pytest.mark.parametrize("side", ["--listen", "--connect"])
@pytest.mark.parametrize(
    ("endpoint", "remedy"),
    [("nonsense", "tls/192.168.1.5:7447"), ("tcp/192.0.2.1:7447", "--insecure"), *WITHOUT_PORT],
)
def test_an_operator_s_endpoint_that_cannot_be_used_leaves_no_recording(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, side: str, endpoint: str, remedy: str
) -> None:
    recorded = tmp_path / "recorded"
    line = refusal(capsys, ["receive", "--no-ros", "--record", str(recorded), side, endpoint], 1)
    assert line.startswith(f"{endpoint}: error: ")
    assert remedy in line
    assert not recorded.exists()


@pytest.mark.parametrize("end", [["receive", "--no-ros"], RUN])
def test_a_port_of_metrics_in_use_is_said_in_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, end: list[str]
) -> None:
    recorded = tmp_path / "recorded"
    record = ["--record", str(recorded)] if end[0] == "receive" else []
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        line = refusal(capsys, [*end, *record, "--openmetrics", port], 1)
    assert line == (
        f"127.0.0.1:{port}: error: metrics cannot be served there: Address already in use; give another port"
    )
    assert not recorded.exists()


@pytest.mark.parametrize("option", ["--incidents", "--catch-up"])
@pytest.mark.parametrize(
    ("folder", "cause"), [("file", "a file is there in place of a folder"), ("file/below", "a file is there")]
)
def test_a_folder_of_what_is_fetched_that_takes_nothing_is_said_at_the_start(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, option: str, folder: str, cause: str
) -> None:
    (tmp_path / "file").write_text("")
    where = str(tmp_path / folder)
    line = refusal(capsys, ["receive", "--no-ros", option, where, "--listen", "nonsense"], 1)
    assert line.startswith(f"{where}: error: the folder of {option} cannot be written: {cause}")


def test_a_port_in_use_is_said_in_one_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
        line = refusal(
            capsys, ["receive", "--no-ros", "--record", str(tmp_path / "recorded"), "--listen", endpoint], 1
        )
    assert line.startswith(f"{endpoint}: error: ")
    assert line.endswith("; is the endpoint right, and free?")
