# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from functools import partial

from smarttestudo.cli.budget import budget_kb_per_s
from smarttestudo.cli.paths import file_path
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.robot import LAST_DOMAIN, DiscoveryRange, OutputDomain
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.robot.option import AnyOption, Settings, given_as


def add_rules(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    parser.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="extend",
        type=file_path,
        required=required,
        help="rule files, or folders of them; several form one set",
    )
    parser.add_argument(
        "--profile", metavar="FILE", type=file_path, help="what is known about the topics (TOML)"
    )
    parser.add_argument(
        "--budget",
        metavar="N",
        type=budget_kb_per_s,
        help="KB/s that all relayed topics together may take; rates are cut by priority, not below floors",
    )
    add_when_slow(parser)


def add_when_slow(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--when-slow",
        choices=[mode.value for mode in WhenSlow],
        default=WhenSlow.PASS.value,
        help="what to do where a target is above its source: pass what comes (default), or repeat the newest",
    )


def add_option(parser: argparse._ActionsContainer, flag: str, option: AnyOption) -> None:
    """Add ``option`` of a run under ``flag``; what is not given is ``None``."""
    default = option.default
    if default is False:
        parser.add_argument(flag, action="store_const", const=True, dest=option.key, help=option.help)
        return
    if option.is_list:
        parser.add_argument(
            flag,
            metavar=option.metavar,
            nargs=option.nargs,
            action="append" if option.nargs is None else "extend",
            dest=option.key,
            help=option.help,
        )
        return
    shown = f" (default: {f'{default:g}' if isinstance(default, float) else default})" if default else ""
    parser.add_argument(
        flag,
        metavar=option.metavar,
        dest=option.key,
        type=partial(given_value, option),
        help=f"{option.help}{shown}",
    )


def settings_of(arguments: argparse.Namespace, options: Iterable[AnyOption]) -> Settings:
    """The values that the command line has for ``options``. Raises ``UsageError``."""
    known = [one for one in options if one.flag is not None]
    return Settings(known, {one.key: given_as(getattr(arguments, one.attribute)) for one in known})


def given_value(option: AnyOption, text: str) -> ParameterValue:
    """Value that a parameter would hold; ``ArgumentTypeError`` for a text that the option cannot have."""
    try:
        return given_as(option.from_text(text))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def add_ros_arguments(parser: argparse.ArgumentParser) -> None:
    """Add ``--ros-args``, which takes all that follows."""
    parser.add_argument(
        "--ros-args",
        metavar="ARG",
        nargs=argparse.REMAINDER,
        default=[],
        help="all that follows goes to ROS, as in --ros-args -r __ns:=/tb3_0 -p use_sim_time:=true",
    )


_MIN_SECONDS = 1.0
_MAX_SECONDS = 86_400.0


def add_simulation(
    parser: argparse.ArgumentParser, *, full_images_help: str, medium_images_help: str | None = None
) -> None:
    """Add ``--seed`` and ``--full-images``, and where they have a help ``--medium-images``."""
    parser.add_argument(
        "--seed", metavar="N", type=_seed, default=0, help="fixes all noise (default: %(default)s)"
    )
    images = parser.add_mutually_exclusive_group()
    images.add_argument("--full-images", action="store_true", help=full_images_help)
    if medium_images_help is not None:
        images.add_argument("--medium-images", action="store_true", help=medium_images_help)


def add_mission(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--mission",
        metavar="FILE",
        type=file_path,
        help="drive this tour (TOML, as examples/errands.mission.toml), instead of the patrol of the thesis",
    )


def seconds(text: str) -> float:
    """A duration from the command line; ``ArgumentTypeError`` for anything but 1 s to a day."""
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not _MIN_SECONDS <= number <= _MAX_SECONDS:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds from 1 to {_MAX_SECONDS:.0f}")
    return number


def _seed(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 0 or more")
    return int(text)


def add_output_domain(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--output-domain",
        metavar="N",
        type=domain_number,
        help="publish into ROS domain N, so that the radio carries nothing but what is relayed",
    )
    parser.add_argument(
        "--output-discovery",
        choices=[discovery.value for discovery in DiscoveryRange],
        help="how far that domain reaches (default: as ROS_AUTOMATIC_DISCOVERY_RANGE says)",
    )


def output_domain(arguments: argparse.Namespace) -> OutputDomain | None:
    """The domain that the command line names; ``UsageError`` for a discovery range without one."""
    discovery = None if arguments.output_discovery is None else DiscoveryRange(arguments.output_discovery)
    if arguments.output_domain is not None:
        return OutputDomain(number=arguments.output_domain, discovery=discovery)
    if discovery is not None:
        raise UsageError(
            "it needs an output domain", place="--output-discovery", remedy="add --output-domain N"
        )
    return None


def domain_number(text: str) -> int:
    """A domain from the command line; ``ArgumentTypeError`` for anything but 0 … 232."""
    if not (text.isascii() and text.isdigit()) or int(text) > LAST_DOMAIN:
        raise argparse.ArgumentTypeError(f"a ROS domain is a number from 0 to {LAST_DOMAIN}, not {text!r}")
    return int(text)
