# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The JSON schema of profiles, by which an editor takes and refuses what the commands do."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft7Validator

from rules.test_profile_file import WHOLE
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import ProfileError
from smarttestudo.files.toml_text import parse_toml
from smarttestudo.rules.profile_file import parse_profile, profile_schema

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = profile_schema()
VALIDATOR = Draft7Validator(SCHEMA)
TOPIC = SCHEMA["properties"]["topics"]["additionalProperties"]["properties"]  # type: ignore[index]
ONLY_READ = re.compile(r"must not (fall|rise) from one level|min_hz is above max_hz|has a table already")
"""What compares values of several keys or places, which no schema says."""

NUMBERS = st.one_of(
    st.sampled_from([0, -1, 1e-10, 1e-9, 1e-6, 5e-4, 1e-3, 1.0, 2, 100, 1e6, 1e7, 1e9, 1e10]),
    st.floats(allow_nan=False, allow_infinity=False),
)
VALUES = st.one_of(
    *(
        NUMBERS,
        st.booleans(),
        st.sampled_from(["", "percent", "fraction", "/a", "a//b", "~/x", "/a__b", "9"]),
    ),
    st.lists(NUMBERS, min_size=5, max_size=7),
    st.lists(NUMBERS, min_size=6, max_size=6).map(sorted),
    st.lists(NUMBERS, min_size=6, max_size=6).map(lambda six: sorted(six, reverse=True)),
)
TOPICS = st.dictionaries(st.sampled_from([*TOPIC, "tier_hz"]), VALUES, max_size=3)
PROFILES = st.fixed_dictionaries(
    {},
    optional={
        "budget_kb_per_s": VALUES,
        "settle_s": VALUES,
        "settle": NUMBERS,
        "topics": st.dictionaries(
            st.sampled_from(["/odom", "odom", "~/x", "a//b", "/" + "a" * 247]), TOPICS, max_size=2
        ),
    },
)


def toml_of(profile: Mapping[str, object]) -> str:
    """A profile as TOML; strings and lists of numbers are written as JSON writes them."""
    tables = profile.get("topics", {})
    assert isinstance(tables, Mapping)
    lines = [f"{key} = {json.dumps(value)}" for key, value in profile.items() if key != "topics"]
    for name, table in tables.items():
        lines += [
            f"[topics.{json.dumps(name)}]",
            *(f"{key} = {json.dumps(value)}" for key, value in table.items()),
        ]
    return "\n".join(lines)


def refusal(text: str) -> str | None:
    """Why a profile cannot be read."""
    try:
        parse_profile(text, Path("profile.toml"))
    except ProfileError as error:
        return error.cause
    return None


@given(PROFILES)
def test_what_the_schema_takes_is_read_and_what_it_refuses_is_not(profile: Mapping[str, object]) -> None:
    cause = refusal(toml_of(profile))
    if VALIDATOR.is_valid(profile):
        assert cause is None or ONLY_READ.search(cause)
    else:
        assert cause is not None


@pytest.mark.parametrize(
    "path", sorted(ROOT.glob("src/smarttestudo/rules/presets/*.toml")), ids=lambda path: path.name
)
def test_the_profiles_of_the_package_are_as_the_schema_says(path: Path) -> None:
    values, _ = parse_toml(path.read_text(encoding="utf-8"), path)
    assert list(VALIDATOR.iter_errors(values)) == []


def test_the_schema_is_one_and_explains_every_key(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profile", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
    Draft7Validator.check_schema(SCHEMA)
    assert VALIDATOR.is_valid(parse_toml(WHOLE, Path())[0])
    assert all(key["description"] for key in TOPIC.values())


def test_the_schema_goes_to_a_file_of_its_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "profile.schema.json"
    assert main(["profile", "--schema", "-o", str(path)]) == 0
    assert json.loads(path.read_text(encoding="utf-8")) == SCHEMA
    assert main(["profile", "--schema", "-o", str(path)]) == 1
    assert "the file exists already" in capsys.readouterr().err


def test_the_keys_of_the_reference_are_those_of_the_schema() -> None:
    page = (ROOT / "docs" / "reference" / "files.md").read_text(encoding="utf-8")
    _, _, profiles = page.partition("\n## Profiles\n")
    cells = re.findall(r"^\| (`[^|]+) \|", profiles.partition("\n## ")[0], flags=re.MULTILINE)
    documented = {name for cell in cells for name in re.findall(r"`(\w+)`", cell)}
    assert documented == {*SCHEMA["properties"], *TOPIC}  # type: ignore[misc]
