# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Run the tests of a tier, its parts beside each other, and say what each took and which were slowest.

usage: TIER=quick|test|all run_tests.py
tests/tiers.py says which test is in which tier. What a part printed is in build/tests, and shown if it fails.
"""

from __future__ import annotations

import enum
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

RESULTS = Path("build/tests")
SHOWN = 10
LIVE = (
    "tests/ros",
    "tests/ruler/browser/test_robot.py",
    "tests/link/zenoh/test_datagrams_between_networks.py",
    "tests/test_radio_link.py",
)
"""They are on a ROS graph or a radio, and wait more than they work."""
PROCESSES = ("tests/ros", "tests/ruler/browser")
"""Nothing in these folders is plain."""
REPORTERS = ("default", "junit", "./tests/progress.mjs")
NPM_TEST = ("sh", "scripts/gui_npm.sh", "test", "--", *(f"--reporter={name}" for name in REPORTERS))
QUICK_LEAVES = ("accuracy", "bags/many", "report", "ruler", "simulation")
"""Folders of tests that make recordings, reports or a server."""
BACKGROUND = 10
"""How much less than live tests, which wait for real time, what only computes gets of the processors."""
BESIDE_OTHERS = 3
"""The same where somebody waits for it: beside three busy programs, more would leave it hardly any."""


class Tier(enum.Enum):
    """Each runs what those before it run, and more."""

    QUICK = "quick"
    TEST = "test"
    ALL = "all"


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A command that runs beside the others of its group."""

    name: str
    command: Sequence[str]
    niceness: int = 0

    @property
    def log(self) -> Path:
        """What it prints."""
        return RESULTS / f"{self.name}.log"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """What came of a part."""

    part: Part
    code: int
    seconds: float


def pytest_part(name: str, workers: int, *options: str, niceness: int = 0) -> Part:
    """A part of the Python tests; without workers, nothing runs beside a test."""
    parallel = ("--numprocesses", str(workers), "--dist", "worksteal") if workers else ()
    return Part(
        name=name,
        command=(sys.executable, "-m", "pytest", *reported(name), *parallel, *options),
        niceness=niceness,
    )


def reported(name: str) -> Sequence[str]:
    """The options by which ``pytest`` says how far this part is, and what came of each test."""
    return ("--quiet", "--part", name, "--junitxml", str(RESULTS / f"{name}.xml"))


def plain_part(processors: int, factor: str, *left_out: str) -> Part:
    """The tests that start no process, with a share of each law's examples."""
    others = [option for path in (*PROCESSES, *left_out) for option in ("--ignore", path)]
    options = ("--tiers", "plain", "--examples-factor", factor, *others, "tests")
    return pytest_part("plain", processors, *options, niceness=BESIDE_OTHERS)


def groups_of(tier: Tier) -> Iterator[Sequence[Part]]:
    """The parts of a tier; each group starts when the one before has ended."""
    processors = os.cpu_count() or 1
    make = ("make", "--no-print-directory", "--jobs", "2", "--output-sync=target")
    style = Part(name="style", command=(*make, "lint"), niceness=BACKGROUND)
    page = Part(name="page", command=(*NPM_TEST, "--outputFile.junit", str(Path("..", RESULTS, "page.xml"))))
    if tier is Tier.QUICK:
        yield (style, plain_part(processors, "0.02", *(f"tests/{name}" for name in QUICK_LEAVES)))
    elif tier is Tier.TEST:
        tenth = "0.1"
        tiers = ("--tiers", "journey,contract")
        promises = pytest_part("live", processors + 1, *tiers, "--examples-factor", tenth, "tests")
        yield (style, page, plain_part(processors, tenth), promises)
    else:
        others = [option for path in LIVE for option in ("--ignore", path)]
        kilted = ("sh", "scripts/test_kilted.sh")
        yield (style, page, Part(name="kilted", command=(*kilted, "promises", *reported("kilted"))))
        yield (
            pytest_part("first", processors * 3 // 2, *others, "tests", niceness=BACKGROUND),
            pytest_part("live", processors, "-m", "not calm", *LIVE),
        )
        yield (pytest_part("calm", 0, "-m", "calm", *LIVE),)
        yield (Part(name="calm-kilted", command=(*kilted, "calm", *reported("calm-kilted"))),)


def run_beside(parts: Sequence[Part]) -> Iterator[Ended]:
    """Start all of them; each is told of when it ends."""
    begun_s = time.monotonic()
    # This Python leaves them, and then the ROS of another environment does not load.
    own = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH")
    environment = {name: value for name, value in os.environ.items() if name not in own}
    environment["PYTHON"] = sys.executable
    running: dict[Part, subprocess.Popen[bytes]] = {}
    for part in parts:
        with part.log.open("wb") as log:
            # How far it is goes to the terminal, by its standard error.
            running[part] = subprocess.Popen(
                ["nice", "-n", str(part.niceness), *part.command],
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
            )
    while running:
        for part, process in list(running.items()):
            code = process.poll()
            if code is not None:
                del running[part]
                yield Ended(part=part, code=code, seconds=time.monotonic() - begun_s)
        time.sleep(0.2)


def show(ended: Ended) -> None:
    """Say how a part ended, with all that it printed if it failed."""
    printed = ended.part.log.read_text("utf-8", "replace").rstrip()
    how = "passed" if ended.code == 0 else f"FAILED (exit code {ended.code})"
    if ended.code:
        print(f"\n{printed}\n")
    else:
        for line in printed.splitlines():
            if line.startswith("Not tested: "):
                print(line)
    print(f"{ended.part.name:12}{how} after {ended.seconds:.0f} s", flush=True)


def name_of(case: ElementTree.Element) -> str:
    """The test as ``pytest`` would be asked for it, but for a class; of the page, its file and name."""
    place = case.get("classname", "")
    return f"{place if '/' in place else place.replace('.', '/') + '.py'}::{case.get('name')}"


def seconds_of(case: ElementTree.Element) -> float:
    """How long a test took, with what it prepared."""
    return float(case.get("time", 0))


def has_failed(case: ElementTree.Element) -> bool:
    """Whether a test failed, or what it prepares did."""
    return case.find("failure") is not None or case.find("error") is not None


def summarize() -> None:
    """Print each part's tests, the slowest tests, and the number of all."""
    reports = {path.stem: ElementTree.parse(path).getroot() for path in sorted(RESULTS.glob("*.xml"))}
    cases = {name: list(root.iter("testcase")) for name, root in reports.items()}
    print("\nPart         Tests  Failed  Seconds of tests")
    for name, some in cases.items():
        failures = sum(map(has_failed, some))
        print(f"{name:12}{len(some):>6}  {failures:>6}  {sum(map(seconds_of, some)):>16.0f}")
    every = [case for some in cases.values() for case in some]
    print(f"\nThe {SHOWN} slowest tests (s)")
    for case in sorted(every, key=seconds_of, reverse=True)[:SHOWN]:
        print(f"{seconds_of(case):6.1f}  {name_of(case)}")
    failed = [case for case in every if has_failed(case)]
    for case in failed:
        print(f"FAILED  {name_of(case)}")
    print(f"\n{len(every) - len(failed)} passed, {len(failed)} failed")


def main(tier: Tier) -> int:
    """The exit code: 1 where a part failed."""
    RESULTS.mkdir(parents=True, exist_ok=True)
    for left in RESULTS.iterdir():
        left.unlink()
    failed: list[str] = []
    for group in groups_of(tier):
        for ended in run_beside(group):
            show(ended)
            if ended.code:
                failed.append(ended.part.name)
    summarize()
    if failed:
        print(f"Failed: {' '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(Tier(os.environ["TIER"])))
    except KeyboardInterrupt:
        sys.exit(130)
