# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write docs/reference from the code: checks with their examples, properties that checks read, metrics."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from smarttestudo.adapters.openmetrics.status import STATUS_METRICS
from smarttestudo.adirf.checks import CHECKS, Example, RuleCheck
from smarttestudo.adirf.properties import (
    ARRIVAL_PROPERTIES,
    PropertySpec,
    known_types,
    properties_for_bounds,
    properties_of,
)
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.metric import MetricName
from smarttestudo.domain.profile import Profile
from smarttestudo.use_cases.live.run_metrics import DECISIONS
from smarttestudo.use_cases.receive.reception_metrics import RECEPTION_METRICS

REFERENCE = Path(__file__).resolve().parent.parent / "docs" / "reference"
NOTE = "<!-- Written by scripts/make_reference.py; change the code instead. -->"
LINES_SHOWN = 12


def pages() -> Mapping[Path, str]:
    """The text of each page by its path."""
    return {
        REFERENCE / "checks.md": "\n".join(checks_page()),
        REFERENCE / "properties.md": "\n".join(properties_page()),
        REFERENCE / "metrics.md": "\n".join(metrics_page()),
    }


def checks_page() -> Iterator[str]:
    """What the checker finds, by severity."""
    yield from (NOTE, "# Findings", "")
    yield "What `testudo check` says about rule files, beside errors of syntax, which explain themselves."
    yield "An *error* stops a file from being used; a *warning* is most likely not what you meant; an *info*"
    yield "is worth knowing."
    yield from ("", "| code | severity | |", "|---|---|---|")
    for check in CHECKS:
        yield f"| [{check.code}](#{check.code}) | {check.severity.value} | {check.meaning} |"
    yield ""
    for severity in Severity:
        for check in CHECKS:
            if check.severity is severity:
                yield from check_section(check)


def check_section(check: RuleCheck) -> Iterator[str]:
    """One check with its examples."""
    yield from (f"## {check.code}", "", f"*{check.severity.value}.* {check.meaning}", "", check.why, "")
    yield from ("This gives the finding:", "", *example_text(check.bad), "")
    yield from ("This does not:", "", *example_text(check.good), "")


def example_text(example: Example) -> Iterator[str]:
    """The rules, and what they are checked with."""
    lines = example.rules.splitlines()
    if len(lines) > LINES_SHOWN:
        half = LINES_SHOWN // 2
        lines = [*lines[:half], f"    // … {len(lines) - LINES_SHOWN} lines like these …", *lines[-half:]]
    yield from ("```", *lines, "```")
    if example.profile is not None:
        yield from ("", "with the profile", "", "```toml", *profile_text(example.profile), "```")
    if example.bag_topics is not None:
        topics = ", ".join(f"`{topic}` ({type_name})" for topic, type_name in example.bag_topics.items())
        yield from ("", f"with a recording that holds {topics}")


def profile_text(profile: Profile) -> Iterator[str]:
    """The topics of a profile as TOML."""
    for name in profile.topics:
        yield f'[topics."{name}"]'


def properties_page() -> Iterator[str]:
    """What checks can read."""
    yield from (NOTE, "# Properties", "")
    yield "What a `CheckValue` can read: a property from these tables, or any numeric field by its path, for"
    yield "instance `pose.pose.position.x`, `ranges[0]` or `status.status`. What is not a number is unknown."
    yield from ("", "## Every topic", "")
    yield "These need nothing decoded and are never unknown. They come before fields of the same name, which"
    yield "`msg.rate` and the like reach."
    yield from ("", *property_table(ARRIVAL_PROPERTIES.values()), "")
    for type_name in known_types():
        yield from (f"## {type_name}", "", *property_table(properties_of(type_name).values()), "")
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
