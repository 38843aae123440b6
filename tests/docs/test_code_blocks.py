# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Each code block that a reader follows is run, or says why it is not."""

from __future__ import annotations

import json
import re
import shlex

import pytest
from ruamel.yaml import YAML

from docs.code_blocks import ROOT, CodeBlock, Mark, blocks_of, followed_pages
from smarttestudo.cli.commands import command_parser

BLOCKS = [block for page in followed_pages() for block in blocks_of(page)]
RUN_BY = {
    "console": "tests/docs/test_documents.py",
    "pycon": "tests/docs/test_documents.py",
    "adirf": "tests/docs/test_documents.py",
    "sh": "tests/ros/test_documented_commands.py",
    "json": "tests/docs/test_code_blocks.py",
    "json5": "tests/docs/test_code_blocks.py",
    "yaml": "tests/docs/test_code_blocks.py",
}
"""The languages of the blocks that need no mark, and the file that runs them or reads them."""
LEAST_REASON = 12
PROGRAM = re.compile(r"(?:^|[ (])(?:\S*/)?(?:ros2 run smarttestudo )?(testudo|smart_testudo) (.+)")
WORDS_OF_A_SHELL = {"&", ">", "|", "&&"}


def of_language(language: str) -> list[CodeBlock]:
    return [block for block in BLOCKS if block.language == language and block.mark is not Mark.NOT_RUN]


def parts(command: str) -> list[str]:
    """The arguments of a command line, to where the shell takes over."""
    words = shlex.split(command)
    ends = [number for number, word in enumerate(words) if word in WORDS_OF_A_SHELL]
    return words[: ends[0]] if ends else words


@pytest.mark.parametrize("page", followed_pages())
def test_every_block_is_run_or_marked_with_a_reason(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    found = blocks_of(page)
    assert text.count("```") == 2 * len(found), "a block that is not read"
    assert len(re.findall("<!-- (?:not run|run in|run by)", text)) == sum(
        block.mark is not None for block in found
    ), "a mark that is not on the line before a block"
    # A file that the reader saves is used by the commands of its page.
    bare = [block for block in found if block.mark is None and block.title is None]
    assert [str(block) for block in bare if block.language not in RUN_BY] == []
    short = [
        str(block) for block in found if block.mark is Mark.NOT_RUN and len(block.mark_words) < LEAST_REASON
    ]
    assert short == []


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.mark is Mark.RUN_IN], ids=str)
def test_what_is_run_in_another_page_stands_there(block: CodeBlock) -> None:
    there = [one for one in blocks_of(block.mark_words) if one.mark is not Mark.NOT_RUN]
    run = {line for one in there for line in one.commands}
    assert [line for line in block.commands if line not in run] == []


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.mark is Mark.RUN_BY], ids=str)
def test_a_test_that_runs_a_block_names_its_page(block: CodeBlock) -> None:
    assert block.page in (ROOT / block.mark_words).read_text(encoding="utf-8")


def test_every_file_that_runs_blocks_is_there() -> None:
    assert [path for path in set(RUN_BY.values()) if not (ROOT / path).is_file()] == []


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.language == "sh"], ids=str)
def test_every_command_line_is_one_that_testudo_takes(
    block: CodeBlock, capsys: pytest.CaptureFixture[str]
) -> None:
    for line in block.commands:
        if (found := PROGRAM.search(line)) is None:
            continue
        name, arguments = found.groups()
        words = parts(arguments)
        try:
            command_parser().parse_args(words if name == "testudo" else ["run", *words])
        except SystemExit:
            pytest.fail(f"{line}: {capsys.readouterr().err}")


@pytest.mark.parametrize("block", of_language("json5"), ids=str)
def test_a_configuration_of_a_link_is_one_that_zenoh_takes(block: CodeBlock) -> None:
    zenoh = pytest.importorskip("zenoh")
    zenoh.Config.from_json5(block.text)


@pytest.mark.parametrize("block", of_language("json"), ids=str)
def test_json_can_be_read(block: CodeBlock) -> None:
    assert json.loads(block.text)


@pytest.mark.parametrize("block", of_language("yaml"), ids=str)
def test_yaml_can_be_read(block: CodeBlock) -> None:
    assert YAML(typ="safe").load(block.text)
