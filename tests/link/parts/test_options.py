# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run has the options of a link with the part that serves it, and only then."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.loop_options import settings_of
from smarttestudo.cli.run import PART_KINDS, add_arguments
from smarttestudo.domain.errors import UsageError
from smarttestudo.link.parts import LINK_PART
from smarttestudo.link.parts.options import LINK_OPTIONS, link_options, robot_name
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import PartKind


def parser_with(*kinds: PartKind) -> CommandParser:
    parser = CommandParser(prog="testudo run")
    add_arguments(parser, kinds)
    return parser


def given(*arguments: str) -> Settings:
    return settings_of(parser_with(*PART_KINDS).parse_args(["--rules", "r", *arguments]), LINK_OPTIONS)


def test_a_run_without_the_part_has_none_of_its_options() -> None:
    with_it, without = (parser_with(*kinds).format_help() for kinds in ((LINK_PART,), ()))
    flags = [option.flag for option in LINK_OPTIONS if option.flag is not None]
    assert [flag for flag in flags if flag not in with_it] == []
    assert [flag for flag in flags if f"{flag} " in without] == []


def test_all_that_is_given_is_what_the_link_is_opened_with() -> None:
    settings = given(
        *("--link", "tls/a:1", "--link", "tls/b:1", "--link-listen", "tls/[::]:2", "--robot", "ada"),
        *("--accept", "/joy", "/cmd_vel", "--accept", "/goal", "--fetch-budget", "0", "--insecure"),
        *("--zenoh-config", "link.json5", "--datagrams", "on", "--dscp", "46"),
    )
    assert robot_name(settings) == "ada"
    assert link_options(settings) == LinkOptions(
        listen=("tls/[::]:2",),
        connect=("tls/a:1", "tls/b:1"),
        config_file=Path("link.json5"),
        insecure=True,
        commands=("/joy", "/cmd_vel", "/goal"),
        fetch_budget_kb_per_s=0.0,
        needs_datagrams=True,
        dscp=46,
    )


def test_what_is_not_given_has_its_default() -> None:
    assert link_options(given()) is None
    assert link_options(given("--link", "tls/a:1")) == LinkOptions(
        connect=("tls/a:1",), fetch_budget_kb_per_s=math.inf
    )
    assert robot_name(given())


@pytest.mark.parametrize(
    "arguments",
    [
        ("--accept", "/joy"),
        ("--robot", "ada"),
        ("--fetch-budget", "0"),
        ("--insecure",),
        ("--zenoh-config", "x"),
    ],
)
def test_what_only_goes_with_a_link_needs_one(arguments: tuple[str, ...]) -> None:
    with pytest.raises(UsageError, match="it needs a link") as raised:
        link_options(given(*arguments))
    assert raised.value.place == arguments[0]
