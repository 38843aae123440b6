# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write docs/reference from the code: commands, parameters, checks with examples, properties, metrics."""

from __future__ import annotations

import argparse
import re
import runpy
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.checks import LINT_RULES
from smarttestudo.cli.commands import CommandParser, command_parser
from smarttestudo.cli.run import PART_KINDS
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.metric import MetricName
from smarttestudo.domain.parameter import Access, ParameterValue
from smarttestudo.language.properties import (
    ARRIVAL_PROPERTIES,
    SOURCE_MEANINGS,
    PropertySpec,
    known_types,
    properties_for_bounds,
    properties_of,
)
from smarttestudo.link.openmetrics.run_metrics import DECISIONS
from smarttestudo.link.openmetrics.status import STATUS_METRICS
from smarttestudo.link.receive.reception_metrics import RECEPTION_METRICS
from smarttestudo.robot.option import AnyOption
from smarttestudo.robot.run import options_of

if TYPE_CHECKING:
    from checks.lint_cases import Example, LintCases

ROOT = Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "docs" / "reference"
read_cases = runpy.run_path(str(ROOT / "tests" / "checks" / "lint_cases.py"))["read_cases"]
NOTE = "<!-- Written by scripts/make_reference.py; change the code instead. -->"
LINES_SHOWN = 12
CHANGES = {Access.NOBODY: "", Access.ANYONE: "yes", Access.NODE: "by the node"}
NO_BREAK = "\N{NO-BREAK SPACE}"
RULE = {rule.code: rule for rule in LINT_RULES}


@dataclass(frozen=True, slots=True, kw_only=True)
class FindingsPage:
    """A page of findings, those of some themes of the checker."""

    title: str
    file_name: str
    themes: tuple[str, ...]

    @property
    def cases(self) -> Sequence[LintCases]:
        """The cases of all its lint rules, by severity."""
        return by_severity(case for theme in self.themes for case in read_cases(theme))


FINDINGS_PAGES = (
    FindingsPage(title="rates and blocks", file_name="checks-rates.md", themes=("blocks", "rates")),
    FindingsPage(
        title="bounds, recordings and actions", file_name="checks-bounds.md", themes=("bounds", "actions")
    ),
    FindingsPage(title="topics and properties", file_name="checks-topics.md", themes=("topics", "patterns")),
    FindingsPage(title="conditions", file_name="checks-conditions.md", themes=("conditions", "words")),
)


def pages() -> Mapping[Path, str]:
    """The text of each page by its path."""
    return {
        REFERENCE / "checks.md": "\n".join(checks_page()),
        **{REFERENCE / page.file_name: "\n".join(findings_page(page)) for page in FINDINGS_PAGES},
        REFERENCE / "commands.md": "\n".join(commands_page(command_parser())),
        REFERENCE / "parameters.md": "\n".join(parameters_page()),
        REFERENCE / "properties.md": "\n".join(properties_page()),
        REFERENCE / "metrics.md": "\n".join(metrics_page()),
    }


def checks_page() -> Iterator[str]:
    """All that the checker finds, with links to the pages of themes."""
    yield from (NOTE, "# Findings", "")
    yield "What `testudo check` says about rule files, beside errors of syntax, which explain themselves."
    yield "An *error* stops a file from being used; a *warning* is most likely not what you meant; an *info*"
    yield "is worth knowing. Each finding has an example that gives it, and one that does not."
    yield from ("", "| code | severity | |", "|---|---|---|")
    place = {case.code: page.file_name for page in FINDINGS_PAGES for case in page.cases}
    for case in by_severity(case for page in FINDINGS_PAGES for case in page.cases):
        rule = RULE[case.code]
        yield f"| [{rule.code}]({place[rule.code]}#{rule.code}) | {rule.severity.value} | {rule.meaning} |"
    yield ""


def findings_page(page: FindingsPage) -> Iterator[str]:
    """The findings of one page, with their examples."""
    yield from (NOTE, f"# Findings: {page.title}", "")
    yield from ("[All findings](checks.md)", "")
    for case in page.cases:
        yield from lint_section(case)


def by_severity(cases: Iterable[LintCases]) -> Sequence[LintCases]:
    """Errors first, else as they are."""
    order = list(Severity)
    return sorted(cases, key=lambda case: order.index(RULE[case.code].severity))


def lint_section(case: LintCases) -> Iterator[str]:
    """A lint rule with its examples."""
    rule = RULE[case.code]
    yield from (f"## {rule.code}", "", f"*{rule.severity.value}.* {rule.meaning}", "", rule.why, "")
    for example in case.bad:
        yield from ("This gives the finding:", "", *example_text(example), "")
    for example in case.good:
        yield from ("This does not:", "", *example_text(example), "")


def example_text(example: Example) -> Iterator[str]:
    """The rules, and what they are checked with."""
    lines = example.rules.splitlines()
    if len(lines) > LINES_SHOWN:
        half = LINES_SHOWN // 2
        lines = [*lines[:half], f"    // … {len(lines) - LINES_SHOWN} lines like these …", *lines[-half:]]
    yield from ("```", *lines, "```")
    if example.profile:
        yield from ("", "with the profile", "", "```toml", *example.profile.splitlines(), "```")
    if example.bag_topics is not None:
        topics = ", ".join(f"`{topic}` ({type_name})" for topic, type_name in example.bag_topics.items())
        yield from ("", f"with a recording that holds {topics}")


def properties_page() -> Iterator[str]:
    """What checks can read."""
    yield from (NOTE, "# Properties", "")
    yield "What a `CheckValue` can read: a property from these tables, or any numeric field by its path, for"
    yield "instance `pose.pose.position.x`, `ranges[0]` or `status.status`. What is not a number is unknown,"
    yield "and so is what its message says to be unknown, such as a `percentage` below 0."
    yield from ("", "## Every topic", "")
    yield "These need nothing decoded and are never unknown. They come before fields of the same name, which"
    yield "`msg.rate` and the like reach."
    yield from ("", *property_table(ARRIVAL_PROPERTIES.values()), "")
    for type_name in known_types():
        yield from (f"## {type_name}", "", *property_table(properties_of(type_name).values()), "")
    for source, meaning in SOURCE_MEANINGS.items():
        said = f"{meaning[:1].upper()}{meaning[1:]}, [read once a second](../how-to/machine-and-link.md)."
        yield from (f"## {source}", "", said, "")
        yield from (*property_table(properties_of(source).values()), "")
    yield from ("## For KeepWithin", "")
    yield from ("A `KeepWithin` can name these, and whatever checks can read of a message.", "")
    for type_name, specs in properties_for_bounds().items():
        yield from (f"### {type_name}", "", *property_table(specs), "")


def property_table(specs: Iterable[PropertySpec]) -> Iterator[str]:
    """A row for each property."""
    yield from ("| property | unit | range | meaning |", "|---|---|---|---|")
    for spec in specs:
        yield f"| `{spec.name}` | {spec.unit} | {range_text(spec)} | {spec.meaning} |"


def range_text(spec: PropertySpec) -> str:
    """The least and greatest value as an interval."""
    if spec.minimum is None:
        return ""
    opening = "[" if spec.includes_minimum else "("
    closing = ", ∞)" if spec.maximum is None else f", {spec.maximum:g}]"
    return f"{opening}{spec.minimum:g}{closing}".replace("-", "−")


def commands_page(parser: CommandParser) -> Iterator[str]:
    """What each command does, its arguments and options."""
    yield from (NOTE, "# Commands", "", parser.description or "")
    yield "`testudo COMMAND --help` prints what stands here. Exit codes: 0 where all went well, 1 for an"
    yield "error, 2 for a wrong command line, 130 or 143 where Ctrl-C or SIGTERM broke off the"
    yield "work. Of commands that these are to end, such as `run` and `receive`, the code is then 0."
    yield ""
    yield "A recording that was closed without a message is read by every command: a note says so, and the"
    yield "code is 0. Where messages were recorded, or may have been, and none can be read, every command"
    yield "ends with code 1."
    for command in leaves(parser):
        yield from ("", f"## {command.prog}", "", command.description or "", "")
        yield from ("```text", *usage(command), "```")
        yield from ("", "| argument | |", "|---|---|")
        yield from (f"| {signature(action)} | {explanation(action)} |" for action in arguments(command))
    yield ""


def leaves(parser: CommandParser) -> Iterator[CommandParser]:
    """The commands that do something, in the order of the help."""
    parser.fill()
    commands = [action.choices for action in arguments(parser) if isinstance(action.choices, Mapping)]
    if not commands:
        yield parser
    for choices in commands:
        for command in choices.values():
            yield from leaves(command)


def arguments(command: CommandParser) -> Sequence[argparse.Action]:
    """Its arguments and options but ``--help``."""
    known = command._actions  # noqa: SLF001  argparse has no other name for it
    return [action for action in known if action.dest != "help"]


def usage(command: CommandParser) -> Iterator[str]:
    """How it is written, in lines; options that may be left out stand in brackets."""
    shown = [words_of(action) for action in arguments(command)]
    words = [text.replace(" ", NO_BREAK) for text in (command.prog, *shown)]
    indent = " " * (len(command.prog) + 1)
    for line in textwrap.wrap(" ".join(words), 80, subsequent_indent=indent, break_on_hyphens=False):
        yield line.replace(NO_BREAK, " ")


def words_of(action: argparse.Action) -> str:
    """An argument as a command line has it."""
    if not action.option_strings:
        return {"?": "[{}]", "*": "[{} ...]", "+": "{} [{} ...]"}.get(str(action.nargs), "{}").replace(
            "{}", name_of_values(action)
        )
    words = f"{action.option_strings[0]} {values(action)}".rstrip()
    return words if action.required else f"[{words}]"


def signature(action: argparse.Action) -> str:
    """An argument with all its names."""
    names = ", ".join(f"`{f'{name} {values(action)}'.rstrip()}`" for name in action.option_strings)
    return (names or f"`{name_of_values(action)}`").replace("|", "\\|")


def values(action: argparse.Action) -> str:
    """What stands after an option."""
    if action.nargs == 0:
        return ""
    name = name_of_values(action)
    return {"?": f"[{name}]", "*": f"[{name} ...]", "+": f"{name} [{name} ...]", "...": "..."}.get(
        str(action.nargs), name
    )


def name_of_values(action: argparse.Action) -> str:
    """What a value is called."""
    if action.metavar is not None:
        return action.metavar if isinstance(action.metavar, str) else " ".join(action.metavar)
    if action.choices is not None:
        return f"{{{','.join(map(str, action.choices))}}}"
    return action.dest.upper()


def explanation(action: argparse.Action) -> str:
    """The help of an argument in a cell."""
    return in_cell((action.help or "") % {**vars(action), "prog": "testudo"})


def in_cell(text: str) -> str:
    """A text as a cell of a table shows it."""
    return re.sub(r"([|*<])", r"\\\1", " ".join(text.split()))


def parameters_page() -> Iterator[str]:
    """What can be set of the node of a run."""
    yield from (NOTE, "# Parameters of the node", "")
    yield "The options of `testudo run` are also parameters of its node:"
    yield "`--ros-args -p rules_file:=warehouse.adirf`, a `--params-file`, a launch file. The command line"
    yield "wins. Options of the link, the output domain, the data path and metrics are"
    yield "[on the command line](commands.md#testudo-run) only."
    yield from ("", "| parameter | option | default | may change | meaning |", "|---|---|---|---|---|")
    yield from (parameter_row(option) for option in options_of(PART_KINDS) if option.name)
    yield ""
    yield "`rules_hash` is that of all files, one after the other: `cat a.adirf b.adirf | sha256sum`."
    yield "`rules_in_force` is"
    yield '`{"sha256", "files": [{"name", "text"}], "full_names": {"odom": "/tb3_0/odom"}}`; `full_names`'
    yield "has the topics whose name in ROS differs from that in the texts. Without rules there are no files."
    yield "`writable_rules_file` is empty for several rule files, too. A changed profile is read again as"
    yield "changed rules are. See also [what rules record](../incidents.md) and"
    yield "[the inputs of the loop](../how-to/why-this-rate.md#again-exactly-as-it-was)."
    yield ""


def parameter_row(option: AnyOption) -> str:
    """A parameter in a row."""
    default = "" if option.default in ("", None) else f"`{yaml_of(option.default)}`"
    flag = f"`{option.flag}`" if option.flag else ""
    return f"| `{option.name}` | {flag} | {default} | {CHANGES[option.access]} | {in_cell(option.help)} |"


def yaml_of(value: ParameterValue) -> str:
    """A value as a file of parameters has it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def metrics_page() -> Iterator[str]:
    """What Prometheus can collect."""
    yield from (NOTE, "# Metrics", "")
    yield "What `--openmetrics` serves. Every metric of a robot has the label `robot`: the name that"
    yield "`--robot` gave it, else that of its machine. A number that is not known has no sample."
    yield from ("", "## A robot", "")
    yield "From `testudo run`, and, except the decisions, from `testudo receive` for each robot whose status"
    yield "arrives there."
    yield from ("", *metric_table((DECISIONS, *STATUS_METRICS)), "", "## The operator's end", "")
    yield "From `testudo receive`."
    yield from ("", *metric_table(RECEPTION_METRICS), "")


def metric_table(names: Iterable[MetricName]) -> Iterator[str]:
    """A row for each metric."""
    yield from ("| metric | type | labels | meaning |", "|---|---|---|---|")
    for name in names:
        labels = ", ".join(f"`{label}`" for label in name.labels)
        yield f"| `{name.sample_name}` | {name.kind.value} | {labels} | {name.help} |"


def main() -> None:
    """Write the pages."""
    for path, text in pages().items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
