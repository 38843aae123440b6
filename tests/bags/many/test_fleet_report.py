# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag report`` over many recordings, as a user runs it, against what is said of each alone."""

from __future__ import annotations

import html
import json
import shlex
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import START_NS, BagContent, BagTopic, small_mission, write_bag, write_mcap_file
from bags.many.commands import Command
from bags.many.dask_processes import DaskProcesses
from bags.many.fleet_factory import day_of, write_fleet
from bags.many.page_tables import Tables
from docs.code_blocks import blocks_of
from report.bag_desk import Ran, thinned

PAGE = "docs/how-to/many-recordings.md"
RULES = """begin
    SetFrequency /odom 10
    SetFrequency /image 5
    Rule "Far"
    If (CheckValue /odom pose_y > 0.2)
    Then
        SetFrequency /odom 20
    EndIf
end
"""
ALONE = ("--workers", "1")
"""Processes take longer to begin than these recordings."""
Documents = list[dict[str, Any]]


def page(path: Path) -> Tables:
    return Tables(path.read_text("utf-8"))


def whole(cells: dict[str, str]) -> dict[str, int]:
    return {name: int(cell.replace(" ", "")) for name, cell in cells.items() if cell != "–"}


def report(testudo: Command, *words: str) -> Ran:
    return testudo("bag", "report", *words, *ALONE)


def documents(ran: Ran) -> Documents:
    return [json.loads(line) for line in ran.out.splitlines()]


@pytest.fixture(scope="module")
def robots_made_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robots")
    write_fleet(folder / "fleet", robots=3, days=4)
    write_fleet(folder / "received", robots=3, days=4, every=4)
    (folder / "rules.adirf").write_text(RULES)
    return folder


@pytest.fixture
def robots(robots_made_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(robots_made_once, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_sizes_on_the_page_are_the_sums_of_each_recordings_json(testudo: Command, robots: Path) -> None:
    each = documents(testudo("bag", "bandwidth", "fleet", "--json", *ALONE))
    topics, of_robots = Counter[str](), Counter[str]()
    for one in each:
        for topic, numbers in one["topics"].items():
            topics[topic] += numbers["messages"]
            of_robots[one["bag"].split("/")[1]] += numbers["messages"]
    ran = report(testudo, "fleet")
    size_mb = sum(one["total"]["bytes"] for one in each) / 1e6
    assert (ran.code, ran.err) == (0, "")
    assert ran.out == f"report.html: 12 recordings, 3 robots, 5.7 s, {size_mb * 1000:.1f} KB\n"
    shown = page(robots / "report.html")
    assert whole(shown.column("Topics", 3)) == topics
    assert whole(shown.column("Robots", 2)) == of_robots
    assert whole(shown.column("Recordings", 2)) == {one["bag"]: one["total"]["messages"] for one in each}
    sizes = [one["total"]["bytes"] for one in each]
    volumes = [float(cell.replace(" ", "")) for cell in shown.column("Recordings", 1).values()]
    assert volumes == sorted((round(size / 1000, 2) for size in sizes), reverse=True)


def test_a_topic_without_a_message_leaves_the_losses_of_the_others_known(
    testudo: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    silent = BagTopic("/alarm", "std_msgs/msg/String")
    for folder, every in (("fleet", 1), ("received", 4)):
        for day in range(2):
            content = day_of(0, day, every=every)
            write_bag(Path(folder, f"{day}"), BagContent((*content.topics, silent), content.messages))
    ran = report(testudo, "fleet", "received", "--csv")
    lost = {row["topic"]: row["lost_messages"] for row in ran.csv}
    assert (ran.code, ran.err) == (0, "wrote report.html\n")
    assert lost == {"/alarm": "", "/image": "15", "/odom": "15", "/scan": "15"}


def test_the_losses_on_the_page_are_the_sums_of_each_pairs_json(testudo: Command, robots: Path) -> None:
    lost, of_robots, of_pairs = Counter[str](), Counter[str](), Counter[str]()
    oldest_s: dict[str, float] = {}
    for one in documents(testudo("bag", "loss", "fleet", "received", "--json", *ALONE)):
        for topic, numbers in one["topics"].items():
            missing = numbers["sent"]["messages"] - numbers["received"]["messages"]
            lost[topic] += missing
            of_robots[one["a"].split("/")[1]] += missing
            of_pairs[one["a"]] += missing
            oldest_s[topic] = max(oldest_s.get(topic, 0.0), numbers["received"]["age"]["max_s"])
    assert report(testudo, "fleet", "received").code == 0
    shown = page(robots / "report.html")
    assert whole(shown.column("Topics", 1)) == lost
    assert whole(shown.column("Robots", 1)) == of_robots
    assert whole(shown.column("Recordings", 1)) == of_pairs
    assert {name: float(cell) for name, cell in shown.column("Topics", 3).items()} == {
        topic: round(age_s, 1) for topic, age_s in oldest_s.items()
    }
    off_m = [float(cell) for cell in shown.column("Robots", 4).values()]
    assert len(off_m) == 3
    assert all(off_m)


def test_rules_have_what_their_seconds_hold(testudo: Command, robots: Path) -> None:
    """A second opinion by the messages, in recordings that lie in one second each."""
    shutil.rmtree(robots / "fleet")
    begins = [START_NS // 10**9 * 10**9 + (2 * day + robot) * 10**9 for day in range(2) for robot in range(2)]
    for number, start_ns in enumerate(begins):
        content = small_mission(0.8)
        moved = [
            type(one)(one.topic, one.stamp_ns - START_NS + start_ns, one.payload) for one in content.messages
        ]
        write_bag(robots / "fleet" / f"r{number}" / "one", BagContent(content.topics, tuple(moved)))
    assert report(testudo, "fleet", "--rules", "rules.adirf").code == 0
    rules = page(robots / "report.html").column("Rules", 2)
    # At 0.5 s, the middle of its second, each robot has driven half a metre.
    assert whole(rules) == {"Far": 4 * 20, "Far (in doubt)": 0, "Defaults": 4 * 4}


def test_bounds_are_judged_as_of_each_pair(testudo: Command, robots: Path) -> None:
    bounded = RULES.replace("begin", "begin\n    KeepWithin /odom pose_y 0.05")
    (robots / "bounds.adirf").write_text(bounded)
    words = ("fleet", "received", "--rules", "bounds.adirf")
    losses = documents(testudo("bag", "loss", *words, "--json", *ALONE))
    judged = [one for loss in losses for one in loss["bounds"]]
    assert report(testudo, *words).code == 0
    (row,) = page(robots / "report.html").rows["Bounds of the rules"][1:]
    broken, messages = (sum(one[key] for one in judged) for key in ("broken", "messages"))
    assert 0 < broken < messages
    assert [row[0], row[1], row[6]] == ["/odom pose_y", str(broken), str(messages)]
    assert float(row[3]) == pytest.approx(max(one["worst"] for one in judged if one["worst"]), rel=0.01)


def test_one_worker_two_and_a_cluster_write_the_same_bytes(
    testudo: Command, robots: Path, cluster: DaskProcesses
) -> None:
    pages, rows = [], []
    for options in (("--workers", "1"), ("--workers", "2"), ("--dask", cluster.address)):
        words = ("--rules", "rules.adirf", "-o", "page.html", "--csv", *options)
        ran = testudo("bag", "report", f"{robots}/fleet", f"{robots}/received", *words)
        assert (ran.code, ran.err) == (0, "wrote page.html\n")
        pages.append((robots / "page.html").read_bytes())
        rows.append(ran.out)
    assert len(set(pages)) == len(set(rows)) == 1
    assert len(rows[0].splitlines()) == 1 + 12 * 3


def test_what_cannot_be_read_is_on_the_page_and_the_rest_is_complete(testudo: Command, robots: Path) -> None:
    (robots / "fleet" / "r0" / "00" / "00.mcap").write_bytes(b"")
    write_bag(robots / "fleet" / "r0" / "empty", BagContent(day_of(0, 0).topics))
    (robots / "fleet" / "r1" / "notes.mcap").write_text("SELECT * FROM robots")
    write_mcap_file(robots / "fleet" / "r2" / "cut.mcap", small_mission())
    with (robots / "fleet" / "r2" / "cut.mcap").open("r+b") as file:
        file.truncate(6_000)
    ran = report(testudo, "fleet/*/*")
    assert ran.code == 1
    errors = [line for line in ran.err.splitlines() if not line.startswith("note: ")]
    assert [line.partition(": error: ")[0] for line in errors] == [
        "fleet/r0/00/00.mcap",
        "fleet/r1/notes.mcap",
    ]
    assert ran.out.startswith("report.html: 13 recordings, 3 robots, ")
    assert ran.out.endswith(", 2 unreadable\n")
    assert "1970" not in ran.out
    text = (robots / "report.html").read_text("utf-8")
    notes = [line.removeprefix("note: ") for line in ran.err.splitlines() if line.startswith("note: ")]
    assert "fleet/r0/empty: the recording holds no message" in notes
    assert "1970" not in text
    for line in (*errors, *notes):
        assert f'<li class="words">{html.escape(line)}</li>' in text


def test_what_is_odd_of_a_pair_is_said_once(testudo: Command, robots: Path) -> None:
    for side in ("fleet", "received"):
        write_mcap_file(robots / side / "r2" / "cut.mcap", small_mission())
    with (robots / "fleet" / "r2" / "cut.mcap").open("r+b") as file:
        file.truncate(9_000)
    ran = report(testudo, "fleet/r2", "received/r2")
    notes = [line for line in ran.err.splitlines() if "cut off" in line]
    assert len(notes) == 1
    assert (robots / "report.html").read_text("utf-8").count("cut off") == 1


def test_a_page_of_nothing_but_failures_is_written_too(testudo: Command, robots: Path) -> None:
    for name in ("a.mcap", "b.mcap"):
        (robots / name).write_text("no recording")
    ran = report(testudo, "*.mcap")
    assert (ran.code, ran.out) == (1, "report.html: 0 recordings, 0.0 s, 0.0 KB, 2 unreadable\n")
    assert "Could not be read" in (robots / "report.html").read_text("utf-8")


def test_a_pair_without_a_partner_or_a_common_time_costs_that_pair(testudo: Command, robots: Path) -> None:
    shutil.rmtree(robots / "received" / "r0" / "00")
    shutil.rmtree(robots / "received" / "r1" / "01")
    write_bag(robots / "received" / "r1" / "01", day_of(1, 3, every=4))
    ran = report(testudo, "fleet", "received")
    assert ran.code == 1
    assert "fleet/r0/00: error: received has no recording r0/00; " in ran.err
    assert "fleet/r1/01: what was lost is not known: it has no time in common" in ran.err.replace(
        "fleet/r1/01, received/r1/01: ", "fleet/r1/01: "
    )
    lost = page(robots / "report.html").column("Recordings", 1)
    assert len(lost) == 11
    assert lost["fleet/r1/01"] == "–"


def test_commands_make_reports_that_the_page_then_links_to(
    testudo: Command, robots: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = robots / "night of <b>x & 'y'"
    write_bag(folder / "r1" / "on monday", small_mission())
    write_bag(folder / "r1" / "-o", small_mission())
    (robots / "pages of 2026").mkdir()
    words = (folder.name, "--topics", "/odom", "--rules", "rules.adirf")
    assert report(testudo, *words, "-o", "pages of 2026/all.html").code == 0
    made = page(robots / "pages of 2026" / "all.html")
    assert made.links == []
    with monkeypatch.context() as patch:
        patch.chdir("/")
        for command in made.commands:
            ran = testudo(*shlex.split(command)[1:])
            assert (ran.code, ran.err) == (0, "")
    assert report(testudo, *words, "-o", "pages of 2026/all.html").code == 0
    again = page(robots / "pages of 2026" / "all.html")
    assert len(again.links) == 2
    assert {f"{link}" for link in again.links} == {
        path.name for path in (robots / "pages of 2026").iterdir() if path.name != "all.html"
    }
    for link in again.links:
        assert "/odom" in (robots / "pages of 2026" / link).read_text("utf-8")


def test_the_page_links_to_no_report_of_what_has_changed_since(testudo: Command, robots: Path) -> None:
    write_bag(robots / "days" / "monday", small_mission())
    write_bag(robots / "days" / "tuesday", small_mission())
    rules = robots / "changing.adirf"
    words = ("days", "--rules", rules.name, "-o", "days.html")

    def links_with(text: str) -> int:
        rules.write_text(text, "utf-8")
        assert report(testudo, *words).code == 0
        return len(page(robots / "days.html").links)

    slow, fast = (f"begin SetFrequency /odom {hz} end\n" for hz in (1, 20))
    assert links_with(slow) == 0
    for command in page(robots / "days.html").commands:
        assert testudo(*shlex.split(command)[1:]).code == 0
    assert [links_with(text) for text in (slow, fast, slow)] == [2, 0, 2]
    shutil.rmtree(robots / "days" / "tuesday")
    write_bag(robots / "days" / "tuesday", small_mission(5))
    assert links_with(slow) == 1


def test_names_of_strangers_are_text(testudo: Command, robots: Path) -> None:
    for name in ("<b>x</b>", '" onclick="alert(1)', "\x1b[31m\n\udcff", "$(reboot)`reboot`"):
        folder = robots / "odd" / "<script>alert(1)<|script>"
        folder.mkdir(parents=True, exist_ok=True)
        write_mcap_file(folder / f"{name}.mcap".replace("/", "|"), small_mission())
    ran = report(testudo, "odd/*/*.mcap", "-o", "odd.html")
    assert ran.code == 0
    text = (robots / "odd.html").read_text("utf-8")
    assert "<b>x" not in text
    assert "<script>alert" not in text
    assert "\x1b" not in text
    assert "&lt;b&gt;x&lt;|b&gt;" in text
    commands = page(robots / "odd.html").commands
    found = subprocess.run(
        ["bash", "-c", "testudo() { printf '%s\\0' \"$3\"; }\n" + "\n".join(commands)],
        capture_output=True,
        check=True,
    ).stdout.split(b"\0")[:-1]
    assert sorted(found) == sorted(bytes(path) for path in (robots / "odd").glob("*/*"))


def test_two_hundred_recordings_are_one_page(testudo: Command, robots: Path) -> None:
    recordings = robots / "many"
    for number in range(200):
        (recordings / f"r{number % 7}").mkdir(parents=True, exist_ok=True)
        write_mcap_file(
            recordings / f"r{number % 7}" / f"{number:03}.mcap", day_of(number % 7, 0).between(0, 12)
        )
    ran = report(testudo, "many/*/*.mcap")
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.startswith("report.html: 200 recordings, 7 robots, ")
    shown = page(robots / "report.html")
    assert len(shown.rows["Recordings"]) == 1 + 100
    assert "… and 100 more recordings; --json, --csv and --parquet have them all." in (
        robots / "report.html"
    ).read_text("utf-8")


def test_topics_need_be_in_one_recording_only(testudo: Command, robots: Path) -> None:
    write_bag(robots / "fleet" / "r9" / "gripper", small_mission())
    assert report(testudo, "fleet", "--topics", "/gripper").code == 0
    assert list(page(robots / "report.html").column("Topics", 1)) == ["/gripper"]
    write_bag(robots / "sent" / "one", small_mission())
    write_bag(robots / "sent" / "two", small_mission())
    for name in ("one", "two"):
        write_bag(robots / "got" / name, thinned(5, "/testudo{}"))
    assert report(testudo, "sent", "got", "--topics", "/testudo/odom").code == 0
    assert list(page(robots / "report.html").column("Topics", 1)) == ["/odom"]
    ran = report(testudo, "fleet", "--topics", "/odmo", "-o", "other.html")
    assert (ran.code, ran.err) == (1, "fleet: error: no topic /odmo; `testudo bag info` lists them\n")
    assert not (robots / "other.html").exists()


@pytest.mark.parametrize(
    ("options", "cause"),
    [
        (["--budget", "5"], "--budget: error: it belongs to one recording"),
        (["--decisions", "rules.adirf"], "--decisions: error: it belongs to one recording"),
        (["-o", "fleet/r0/00/00.mcap"], "--output: error: fleet/r0/00/00.mcap lies in fleet/r0/00"),
    ],
)
def test_what_does_not_fit_is_refused(options: list[str], cause: str, testudo: Command, robots: Path) -> None:
    ran = report(testudo, "fleet", *options)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(cause)


@pytest.mark.full
def test_the_commands_of_the_page_do_what_it_says(testudo: Command, robots: Path) -> None:
    import duckdb  # noqa: PLC0415  only full tests need it

    (commands,) = [block.commands for block in blocks_of(PAGE) if "bag report" in block.text]
    for command in commands:
        assert testudo(*shlex.split(command)[1:], *ALONE).code == 0
    assert "Rules" in page(robots / "fleet.html").rows
    assert "Rules" not in page(robots / "sizes.html").rows
    with duckdb.connect() as database:
        rows = database.execute("SELECT count(*), sum(messages) FROM 'numbers/reports/*.parquet'").fetchone()
    total = sum(
        one["total"]["messages"] for one in documents(testudo("bag", "info", "fleet", "--json", *ALONE))
    )
    assert rows == (12 * 3, total)


def test_the_json_of_a_pair_has_the_numbers_of_its_loss(testudo: Command, robots: Path) -> None:
    losses = documents(testudo("bag", "loss", "fleet", "received", "--json", *ALONE))
    each = documents(report(testudo, "fleet", "received", "--json"))
    for one, loss in zip(each, losses, strict=True):
        assert (one["a"], one["b"]) == (loss["a"], loss["b"])
        for topic, numbers in one["topics"].items():
            received = loss["topics"][topic]["received"]
            assert numbers["messages"] == loss["topics"][topic]["sent"]["messages"]
            assert numbers["received"] == {
                "messages": received["messages"],
                "bytes": received["bytes"],
                "age_mean_s": received["age"]["mean_s"],
                "age_max_s": received["age"]["max_s"],
            }


def test_rows_of_one_recording_are_left_to_other_commands(testudo: Command, robots: Path) -> None:
    ran = report(testudo, "fleet/r0/00", "--csv")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err == (
        "--csv: error: it needs several recordings; `testudo bag bandwidth` and `testudo bag loss` have the "
        "numbers of one\n"
    )
