# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo incidents``: listed, shown, exported and deleted, whatever lies in the folder."""

from __future__ import annotations

import errno
import json
import math
import os
import re
from dataclasses import replace
from pathlib import Path

import pytest

from incidents.test_folders import files_of_at_most
from smarttestudo.bags.incident_record import errors_at
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import (
    IncidentRecord,
    IncidentTopic,
    LatchedSample,
    Missing,
    MissingReason,
    incident_text,
)

RECORD = IncidentRecord(
    name="near miss",
    rule="Close call",
    path="rules.adirf",
    line=7,
    triggered_ns=30_000_000_000,
    from_ns=0,
    to_ns=40_000_000_000,
    values={"/scan distance": 0.4, "/odom speed": None},
    rules_sha256="ab" * 32,
    topics={"/scan": IncidentTopic(type_name="sensor_msgs/msg/LaserScan", messages=3, size_bytes=4200)},
    latched=(LatchedSample(topic="/map", stamp_ns=-5),),
    missing=(
        Missing(topic="/scan", reason=MissingReason.MEMORY, messages=2, from_ns=1, to_ns=2_000_000_000),
    ),
)
NAME = "19700101T000030000Z-near_miss"
FILE = f"{NAME}_0.mcap"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "incidents"
    (path / NAME).mkdir(parents=True)
    (path / NAME / "incident.json").write_text(incident_text(RECORD))
    (path / NAME / FILE).write_bytes(b"messages")
    return path


def add_broken(folder: Path, name: str, text: str) -> None:
    (folder / name).mkdir()
    (folder / name / "incident.json").write_text(text)


def test_all_are_listed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["incidents", "list", str(folder)]) == 0
    out = capsys.readouterr().out
    assert all(word in out for word in (NAME, "Close call", "memory"))
    assert main(["incidents", "list", str(folder), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found["incident"] == NAME
    assert found["missing"] == [
        {"topic": "/scan", "reason": "memory", "messages": 2, "from_ns": 1, "to_ns": 2_000_000_000}
    ]


def test_one_is_shown(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["incidents", "show", str(folder), NAME]) == 0
    out = capsys.readouterr().out
    assert "near miss: 1970-01-01 00:00:30.000 UTC, 30 s before to 10 s after" in out
    assert "rule Close call (rules.adirf:7), rules abababababab" in out
    assert "/scan distance = 0.4\n/odom speed = unknown or infinite" in out
    assert "missing: /scan: 2 messages from 1970-01-01" in out


def test_moments_are_listed_counted_and_the_first_of_many_shown(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = RECORD
    for number in range(1, 30):
        record = record.extended(
            RECORD.triggered_ns + number * 500_000_000, {"/scan distance": number / 2}, 10**11
        )
    (folder / NAME / "incident.json").write_text(incident_text(record))
    assert main(["incidents", "list", str(folder)]) == 0
    assert re.search(r"Close call +30 ", capsys.readouterr().out)
    assert main(["incidents", "list", str(folder), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert (found["moments"], len(found["further_moments"])) == (30, 29)
    assert main(["incidents", "show", str(folder), NAME]) == 0
    out = capsys.readouterr().out
    assert "again after 0.5 s, /scan distance = 0.5\nagain after 1 s, /scan distance = 1\n" in out
    assert "\nand 9 times more ('--json' shows 29 in all)\n" in out


def test_an_infinite_value_is_shown_and_is_null_to_who_does_not_know_that(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    infinite = replace(RECORD, values={"/scan distance": math.inf, "/odom speed": None})
    (folder / NAME / "incident.json").write_text(incident_text(infinite))
    assert main(["incidents", "show", str(folder), NAME]) == 0
    assert "/scan distance = inf\n/odom speed = unknown or infinite" in capsys.readouterr().out
    assert main(["incidents", "show", str(folder), NAME, "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["values"] == {"/scan distance": None, "/odom speed": None}
    assert shown["infinite"] == {"/scan distance": "inf"}


def test_one_is_exported_and_deleted(folder: Path, tmp_path: Path) -> None:
    target = tmp_path / "taken" / "away"
    assert main(["incidents", "export", str(folder), NAME, "--output", str(target)]) == 0
    assert {one.name for one in target.iterdir()} == {"incident.json", FILE}
    assert main(["incidents", "export", str(folder), NAME, "--output", str(target)]) == 1
    assert main(["incidents", "delete", str(folder), NAME]) == 0
    assert list(folder.iterdir()) == []


def test_an_export_that_a_full_disk_ends_leaves_nothing(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / NAME / FILE).write_bytes(bytes(100_000))
    target = tmp_path / "taken" / "away"
    with files_of_at_most(50_000):
        assert main(["incidents", "export", str(folder), NAME, "--output", str(target)]) == 1
    assert str(target) in capsys.readouterr().err
    assert list(target.parent.iterdir()) == []
    assert main(["incidents", "export", str(folder), NAME, "--output", str(target)]) == 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (incident_text(RECORD)[:200], "does not hold the record of an incident"),
        ("[]", "does not hold the record of an incident"),
        ("[" * 100_000, "does not hold the record of an incident"),
        (incident_text(RECORD).replace('"memory"', '"moths"'), "does not hold the record of an incident"),
        (incident_text(RECORD).replace('"version": 1', '"version": 2'), "version 2 of an incident"),
        ("x" * 5_000_000, "too large"),
    ],
)
def test_one_that_cannot_be_read_costs_only_itself(
    folder: Path, capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    add_broken(folder, "broken", text)
    assert main(["incidents", "list", str(folder)]) == 1
    captured = capsys.readouterr()
    assert NAME in captured.out
    assert said in captured.err
    assert len(captured.err.splitlines()) == 1


def test_folders_that_are_no_incidents_are_named_with_what_to_do(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "ada" / NAME).mkdir(parents=True)
    (folder / "Notizen über März").mkdir()
    (folder / NAME).rename(folder / "Unfall im März")
    assert main(["incidents", "list", str(folder)]) == 1
    lacks = "is no incident: it has no incident.json; name this folder itself if there are incidents in it"
    assert capsys.readouterr().err.splitlines() == [
        f"{folder / 'Notizen über März'}: error: {lacks}",
        f"{folder / 'Unfall im März'}: error: the name of an incident has at most 100 letters from a to z, "
        "digits, - and _; rename the folder",
        f"{folder / 'ada'}: error: {lacks}",
    ]
    assert main(["incidents", "show", str(folder), "ada"]) == 1
    assert capsys.readouterr().err == f"{folder / 'ada'}: error: {lacks}\n"


@pytest.mark.parametrize(
    "name", ["..", ".", "", "../incidents", "/etc", f"{NAME}/..", "linked", "x" * 10_000]
)
def test_nothing_outside_the_folder_is_touched(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "incident.json").write_text(incident_text(RECORD))
    (folder / "linked").symlink_to(outside)
    for action in (["delete"], ["show"], ["export"]):
        options = ["--output", str(tmp_path / "copy")] if action == ["export"] else []
        assert main(["incidents", *action, str(folder), name, *options]) == 1
        assert "there is no incident" in capsys.readouterr().err
    assert (outside / "incident.json").exists()
    assert (folder / NAME).exists()


def test_links_in_an_incident_are_not_followed(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    secret = tmp_path / "secret"
    secret.write_text("secret")
    (folder / NAME / FILE).unlink()
    (folder / NAME / FILE).symlink_to(secret)
    assert main(["incidents", "export", str(folder), NAME, "--output", str(tmp_path / "copy")]) == 0
    assert {one.name for one in (tmp_path / "copy").iterdir()} == {"incident.json"}
    (folder / NAME / "incident.json").unlink()
    (folder / NAME / "incident.json").symlink_to(secret)
    assert main(["incidents", "show", str(folder), NAME]) == 1
    assert "is not a file" in capsys.readouterr().err


def test_one_that_was_shown_or_exported_counts_as_read(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def is_read() -> bool:
        capsys.readouterr()
        assert main(["incidents", "list", str(folder), "--json"]) == 0
        found: bool = json.loads(capsys.readouterr().out)[0]["read"]
        return found

    assert not is_read()
    assert main(["incidents", "show", str(folder), NAME]) == 0
    assert is_read()
    assert main(["incidents", "export", str(folder), NAME, "--output", str(tmp_path / "copy")]) == 0
    assert {one.name for one in (tmp_path / "copy").iterdir()} == {"incident.json", FILE}


def test_a_folder_that_is_none_is_named_with_the_command_that_writes_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").touch()
    for name, said in (("nowhere", "no such folder"), ("file", "is not a folder")):
        assert main(["incidents", "list", str(tmp_path / name)]) == 1
        remedy = "name the one that 'testudo run --incidents DIR' wrote into"
        assert capsys.readouterr().err == f"{tmp_path / name}: error: {said}; {remedy}\n"


def test_a_robot_is_named_for_a_link_and_not_for_a_folder(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["incidents", "list", str(folder), "--robot", "ada"]) == 2
    assert capsys.readouterr() == ("", "--robot: error: it needs a link; add --connect\n")


def test_what_may_not_be_read_says_what_to_check(tmp_path: Path) -> None:
    with pytest.raises(RecordingError) as refused, errors_at(tmp_path):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    remedy = "check its permissions and those of its folder"
    assert str(refused.value) == f"{tmp_path}: error: Permission denied; {remedy}"
