# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the documentation shows is true: commands print it, rules are valid, links lead somewhere."""

from __future__ import annotations

import fnmatch
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from made_demos import made_demo, run_testudo_in
from smarttestudo.cli.run import PART_KINDS
from smarttestudo.domain.errors import ProfileError
from smarttestudo.language.formatter import format_rules
from smarttestudo.language.parser import parse
from smarttestudo.robot.run import options_of
from smarttestudo.rules.profile_file import load_profile

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
BLOCK = re.compile(r"^```(\w+)(?: title=\"[^\"\n]*\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"^```[\w-]+ title=\"([\w.]+)\"\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


@dataclass(frozen=True, kw_only=True)
class Command:
    """A command line of a console block with the output that is shown below it."""

    line: str
    output: str


def blocks(document: Path, language: str) -> Iterator[str]:
    return (text for kind, text in BLOCK.findall(document.read_text(encoding="utf-8")) if kind == language)


def commands(document: Path) -> Iterator[Command]:
    for block in blocks(document, "console"):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            line, _, output = part.partition("\n")
            yield Command(line=line, output=output)


def write_named_files(document: Path, folder: Path) -> None:
    """Save the blocks with a title, as the reader is told to."""
    for name, text in NAMED.findall(document.read_text(encoding="utf-8")):
        (folder / name).write_text(text, encoding="utf-8")


def documents_with(language: str) -> list[Path]:
    return [document for document in DOCUMENTS if any(blocks(document, language))]


def run(command: Command, folder: Path, factory: pytest.TempPathFactory) -> str:
    """What the command prints; several documents begin with the same demo."""
    program, *arguments = shlex.split(command.line)
    if program == "cat":
        return (folder / arguments[0]).read_text(encoding="utf-8")
    assert program == "testudo", f"a console block may run testudo and cat only: {command.line}"
    if arguments[0] == "demo":
        made, ran = made_demo(factory, *arguments[1:])
        shutil.copytree(made, folder / made.name, dirs_exist_ok=True)
    else:
        ran = run_testudo_in(folder, *arguments)
    return ran.stdout + ran.stderr


def wrong_examples(document: Path, folder: Path) -> str:
    """Where the Python examples of ``document``, run in ``folder``, print something else."""
    examples = folder / "examples.txt"
    examples.write_text("\n".join(blocks(document, "pycon")), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "doctest", "-o", "ELLIPSIS", examples.name],
        cwd=folder, env={**os.environ, "PYTHONIOENCODING": "utf-8"}, capture_output=True, encoding="utf-8",
        check=False,
    )  # fmt: skip
    return done.stdout + done.stderr


def agrees(shown: str, printed: str) -> bool:
    """Whether ``printed`` is as ``shown``, where … stands for any text."""
    pattern = re.sub(r"\[", "[[]", shown.strip()).replace("*", "[*]").replace("?", "[?]").replace("…", "*")
    return fnmatch.fnmatchcase(printed.strip(), pattern)


@pytest.mark.parametrize("document", documents_with("console"), ids=lambda path: path.name)
def test_commands_print_what_the_document_shows(
    document: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    for folder in ("examples", "src/smarttestudo/rules/presets"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    write_named_files(document, tmp_path)
    for command in commands(document):
        printed = run(command, tmp_path, tmp_path_factory)
        assert agrees(command.output, printed), f"$ {command.line}\n{printed}"
    assert wrong_examples(document, tmp_path) == ""


@pytest.mark.parametrize("document", documents_with("adirf"), ids=lambda path: path.name)
def test_rule_files_in_documents_are_valid_and_formatted(document: Path) -> None:
    for text in blocks(document, "adirf"):
        assert parse(text, document.name).findings == ()
        assert format_rules(text, document.name) == text


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_to_files_that_exist(document: Path) -> None:
    links = [link for link in LINK.findall(document.read_text(encoding="utf-8")) if "://" not in link]
    missing = [link for link in links if not (document.parent / link).exists()]
    assert missing == []


def rooms_of_the_architecture() -> str:
    """The table of rooms."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    return text.partition("\n## Rooms\n")[2].partition("\n## ")[0]


def test_the_architecture_names_every_room_and_nothing_else() -> None:
    rows = re.findall(r"^\| (`.+?) \|", rooms_of_the_architecture(), flags=re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    package = ROOT / "src" / "smarttestudo"
    folders = {path.name for path in package.iterdir() if (path / "__init__.py").exists()}
    modules = {path.stem for path in package.glob("*.py") if not path.stem.startswith("__")}
    assert named == folders | modules


def test_the_architecture_names_every_part_of_a_room() -> None:
    parts = {init.parent.name for init in (ROOT / "src" / "smarttestudo").glob("*/*/__init__.py")}
    assert {name for name in parts if f"`{name}`" not in rooms_of_the_architecture()} == set()


def test_the_makefile_has_every_target_that_documents_name() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = {
        target
        for document in DOCUMENTS
        for block in blocks(document, "sh")
        for target in re.findall(r"^make ([\w-]+)", block, flags=re.MULTILINE)
    }
    assert {
        target for target in named if not re.search(rf"^{target}:", makefile, flags=re.MULTILINE)
    } == set()


def test_the_pacing_page_shows_what_the_throttle_benchmark_prints() -> None:
    benchmark = ROOT / "benchmarks" / "throttle_accuracy.py"
    done = subprocess.run([sys.executable, benchmark], capture_output=True, encoding="utf-8", check=True)
    assert done.stdout.strip() in (ROOT / "docs" / "pacing.md").read_text(encoding="utf-8")


def test_the_page_of_files_has_every_key_of_a_profile(tmp_path: Path) -> None:
    """The error that names the known keys knows them all."""
    page = (ROOT / "docs" / "reference" / "files.md").read_text(encoding="utf-8").partition("## Profiles")[2]
    shown = {
        key for row in re.findall(r"^\| (`.*?) \|", page, re.MULTILINE) for key in re.findall(r"\w+", row)
    }
    known = set()
    for text in ("zzz = 1", '[topics."/odom"]\nzzz = 1'):
        profile = tmp_path / "profile.toml"
        profile.write_text(text, encoding="utf-8")
        with pytest.raises(ProfileError) as refused:
            load_profile(profile)
        known |= set(re.findall(r"\w+", str(refused.value.remedy).removeprefix("known keys:")))
    assert shown == known


def test_the_page_of_parameters_has_every_parameter() -> None:
    page = (ROOT / "docs" / "reference" / "parameters.md").read_text(encoding="utf-8")
    named = [one.name for one in options_of(PART_KINDS) if one.name]
    assert re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE) == named


def test_the_parameters_that_pages_name_are_the_nodes() -> None:
    """A parameter that the node does not have is taken at its start without a word."""
    named = {
        name
        for document in DOCUMENTS
        for name in re.findall(
            r"(?:\bROS parameter `|ros2 param set /smarttestudo )(\w+)", document.read_text(encoding="utf-8")
        )
    }
    assert "budget_kb_per_s" in named
    assert named <= {one.name for one in options_of(PART_KINDS)}


def test_make_clean_removes_what_git_ignores() -> None:
    lines = (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    ignored = {line.strip("/*").rpartition("/")[2] for line in lines}
    done = subprocess.run(
        ["make", "--dry-run", "clean"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert {name for name in ignored if name not in done.stdout} == {"fleet"}, "those keys are made by hand"
