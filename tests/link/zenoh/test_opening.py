# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of robots, and what is said of a link that cannot be opened."""

from __future__ import annotations

import socket
import sys
from collections.abc import Callable
from inspect import signature
from pathlib import Path

import pytest

from link.zenoh.ends import free_endpoint, refuse_warning, robot_end
from smarttestudo.domain.errors import Extra, TestudoError, UsageError, how_to_install
from smarttestudo.link.protocol.keys import boot_of, new_boot
from smarttestudo.link.zenoh import open_operator_end, open_robot_end, suspended_too_ns
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import session_config


@pytest.mark.parametrize("name", ["r1", "tb3_0", "unit-7", "v1.2", "x" * 64])
def test_a_robot_is_known_by_its_key(name: str) -> None:
    boot = new_boot(name, 2**64 - 1)
    assert boot_of(boot.key) == boot_of(boot.data_key) == boot


@pytest.mark.parametrize(
    "name", ["", "a/b", "*", "**", "a$*", "a?", "a#b", "@x", "a b", "a\n", "r\x1b[31m", "é", "x" * 65]
)
def test_a_name_that_cannot_be_part_of_a_key_is_refused(name: str) -> None:
    with pytest.raises(UsageError, match="--robot"):
        new_boot(name, 1)
    assert boot_of(f"testudo/{name}/0123456789abcdef") is None


@pytest.mark.parametrize("opened", [open_robot_end, open_operator_end])
def test_time_passes_at_an_end_while_its_machine_is_suspended(opened: Callable[..., object]) -> None:
    # After a clock that stood still, all that came would look late to the other end.
    assert signature(opened).parameters["clock"].default is suspended_too_ns


@pytest.mark.parametrize("key", ["testudo/r1", "testudo/r1/xyz", "testudo/r1/0123456789ABCDEF", "other/r1/0"])
def test_other_keys_are_no_robots(key: str) -> None:
    assert boot_of(key) is None


def test_a_wrong_name_is_said_before_anything_is_offered() -> None:
    with pytest.raises(UsageError, match="a/b"), robot_end(free_endpoint(), name="a/b"):
        pass


@pytest.mark.parametrize(
    ("text", "cause"),
    [("{mode:", "1:7"), ("{nonsense: 1}", "nonsense"), ("\x00\xff", "Zenoh configuration"), ("", "config")],
)
def test_a_configuration_that_is_none_is_said_in_one_line(tmp_path: Path, text: str, cause: str) -> None:
    path = tmp_path / "link.json5"
    path.write_bytes(text.encode("latin-1"))
    said = refusal(LinkOptions(connect=(free_endpoint(),), config_file=path))
    assert str(path) in said
    assert cause in said


DEEP = {
    "arrays": "[" * 100_000,
    "objects": "{a:" * 100_000,
    "both": "[{'a':" * 50_000,
    "closed arrays": "{metadata:" + "[" * 100_000 + "]" * 100_000 + "}",
    "closed objects": "{metadata:" + "{a:" * 100_000 + "1" + "}" * 100_000 + "}",
    "more than Python reads": "{metadata:" + "[" * 2_000 + "]" * 2_000 + "}",
    "closed in strings": "{metadata:" + '["]",' * 100_000,
    "closed in comments": "{metadata:" + "[/*]*/" * 100_000,
    "closed in lines of comments": "{metadata:" + "[//]\r" * 100_000,
    "after what a comment only seems to end": "// \u2028" + "[" * 100_000,
    "after an escaped quote": "{metadata:['\\'', " + "[" * 100_000,
    "after what was never open": "]" * 200_000 + "[" * 100_000,
}


@pytest.mark.parametrize("text", DEEP.values(), ids=DEEP)
def test_a_configuration_that_is_too_deep_for_zenoh_never_gets_there(tmp_path: Path, text: str) -> None:
    path = tmp_path / "link.json5"
    path.write_text(text, encoding="utf-8")
    said = refusal(LinkOptions(connect=(free_endpoint(),), config_file=path))
    assert f"{path}: error: it is no Zenoh configuration: " in said


def test_brackets_in_strings_and_comments_count_for_nothing(tmp_path: Path) -> None:
    path = tmp_path / "link.json5"
    many = "[{" * 10_000
    path.write_text(f"{{metadata: ['{many}', \"{many}\"], /* {many} */ mode: 'peer'}} // {many}")
    options = LinkOptions(connect=("tcp/127.0.0.1:1",), config_file=path)
    assert session_config(options, "client", refuse_warning)[1]["mode"] == "peer"


def test_a_configuration_that_is_missing_or_a_folder_is_said_in_one_line(tmp_path: Path) -> None:
    for path in (tmp_path / "none.json5", tmp_path):
        said = refusal(LinkOptions(connect=(free_endpoint(),), config_file=path))
        assert f"{path}: error: " in said
        assert "--zenoh-config" in said


@pytest.mark.parametrize("module", ["zenoh", "zstandard"])
def test_without_the_extra_its_name_is_said(monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    # As where it is not installed.
    monkeypatch.setitem(sys.modules, module, None)
    said = refusal(LinkOptions(connect=(free_endpoint(),)))
    assert module in said
    assert how_to_install(Extra.LINK) in said


def test_a_link_without_an_endpoint_is_refused() -> None:
    assert "endpoint" in refusal(LinkOptions())


def test_a_place_to_listen_that_is_taken_is_said_in_one_line() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
        assert endpoint in refusal(LinkOptions(listen=(endpoint,)))


def test_an_unknown_protocol_is_said_in_one_line() -> None:
    assert "carrier" in refusal(LinkOptions(listen=("carrier/127.0.0.1:1",)))


def test_what_the_configuration_says_of_endpoints_does_not_count(tmp_path: Path) -> None:
    path = tmp_path / "link.json5"
    path.write_text('{mode: "client", listen: {endpoints: ["tcp/0.0.0.0:1"]}, connect: {endpoints: ["x/y"]}}')
    options = LinkOptions(listen=(free_endpoint(),), config_file=path)
    with open_robot_end("r1", options, refuse_warning):
        # The place is taken: it listens there, and not as a client.
        assert options.listen[0] in refusal(options)


def refusal(options: LinkOptions) -> str:
    """What is said where an end cannot be opened."""
    with pytest.raises(TestudoError) as refused, open_operator_end(options, refuse_warning):
        pass
    said = str(refused.value)
    assert "\n" not in said
    assert len(said) < 600
    return said
