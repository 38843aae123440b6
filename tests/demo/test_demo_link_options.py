# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the link of ``testudo demo --link`` is written."""

from __future__ import annotations

import argparse

import pytest

from smarttestudo.cli.commands import command_parser
from smarttestudo.cli.demo import link_bit_per_s, run
from smarttestudo.domain.errors import UsageError


@pytest.mark.parametrize(
    ("text", "bit_per_s"),
    [("2mbit", 2e6), ("500kbit", 5e5), ("1.5Mbit", 1.5e6), ("64kbit", 64e3), ("100000000bit", 1e8)],
)
def test_a_rate_is_read_as_tc_writes_it(text: str, bit_per_s: float) -> None:
    assert link_bit_per_s(text) == bit_per_s


@pytest.mark.parametrize(
    "text",
    [
        "",
        "2",
        "2mbps",
        "0mbit",
        "63kbit",
        "101mbit",
        "1gbit",
        "-2mbit",
        "2 mbit",
        "٢mbit",
        "nanbit",
        "1e6bit",
    ],
)
def test_another_rate_is_refused_with_how_it_is_written(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="64kbit to 100mbit a second, written as in 500kbit"):
        link_bit_per_s(text)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["--seconds", "4"],
            "--seconds: error: the first seconds of a drive over a link do not count; give it at least 5",
        ),
        (
            ["--full-images"],
            "--full-images: error: with --link, frames have a size of their own; leave one out",
        ),
    ],
)
def test_what_does_not_go_with_a_link_is_said_at_once(arguments: list[str], said: str) -> None:
    with pytest.raises(UsageError) as error:
        run(command_parser().parse_args(["demo", "--link", "2mbit", *arguments]))
    assert str(error.value) == said
