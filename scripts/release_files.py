# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Writes package.xml, CITATION.cff and CHANGELOG.rst, which ROS's tools read, for the version.

The version is that of src/smarttestudo/__init__.py, and the text that of CHANGELOG.md.

usage: release_files.py [--check] [--notes] [--maintainer ADDRESS]
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
UNRELEASED = "Unreleased"
TITLE = "Changelog for package smarttestudo"


def version(root: Path) -> str:
    """The version of the package."""
    text = (root / "src/smarttestudo/__init__.py").read_text(encoding="utf-8")
    return found(r'^__version__ = "(.+)"$', text, "src/smarttestudo/__init__.py")


def maintainer(root: Path) -> str:
    """The address of the maintainer in package.xml."""
    return found(
        r'<maintainer email="(.*?)"', (root / "package.xml").read_text(encoding="utf-8"), "package.xml"
    )


def found(pattern: str, text: str, place: str) -> str:
    """What the group of ``pattern`` is in ``text``; without it the program ends."""
    match = re.search(pattern, text, flags=re.MULTILINE)
    if match is None:
        sys.exit(f"{place}: error: nothing is like {pattern}")
    return match[1]


def replaced(pattern: str, new: str, text: str, place: str) -> str:
    """``text`` with the group of ``pattern`` as ``new``; without it the program ends."""
    found(pattern, text, place)
    return re.sub(pattern, lambda match: match[0].replace(match[1], new), text, count=1, flags=re.MULTILINE)


def released(changelog: str, number: str) -> tuple[str, str]:
    """The date and the text of a version in CHANGELOG.md; the program ends where it has none."""
    heading = rf"^## {re.escape(number)} - (\d{{4}}-\d\d-\d\d)$"
    date = found(heading, changelog, "CHANGELOG.md")
    _, _, after = changelog.partition(f"## {number} - {date}\n")
    return date, re.split(r"^## ", after, maxsplit=1, flags=re.MULTILINE)[0].strip()


def rst(changelog: str) -> str:
    """CHANGELOG.md as catkin_pkg and bloom read it; versions without entries are left out."""
    bar = "^" * len(TITLE)
    return "\n".join([bar, TITLE, bar, *rst_lines(changelog)]) + "\n"


def rst_lines(changelog: str) -> Iterator[str]:
    """The lines below the title."""
    for section in re.split(r"^## ", changelog, flags=re.MULTILINE)[1:]:
        heading, _, body = section.partition("\n")
        entries = list(rst_entries(body))
        if not entries:
            continue
        number, _, date = heading.partition(" - ")
        title = "Forthcoming" if number == UNRELEASED else f"{number} ({date})"
        yield from ("", title, "-" * len(title), *entries)


def rst_entries(body: str) -> Iterator[str]:
    """A version's entries: its themes as a list, with theirs below."""
    # A line that is wrapped goes on with the one before.
    whole = re.sub(r"(?<=\S)\n(?!\n|- |### ) *", " ", body)
    for line in filter(None, map(str.strip, whole.splitlines())):
        if line.startswith("### "):
            yield from ("", f"* {rst_inline(line[4:])}", "")
        elif line.startswith("- "):
            yield f"  * {rst_inline(line[2:])}"
        else:
            yield from ("", f"* {rst_inline(line)}", "")


_MARKUP = re.compile(
    r"(?P<ticks>`+)(?P<code>.+?)(?<!`)(?P=ticks)(?!`)|\[(?P<label>[^]]+)\]\((?P<address>\S+?)\)"
    r"|(?P<stars>\*\*?)(?=[^\s*])(?P<stressed>[^*]+)(?<=\S)(?P=stars)|(?P<sign>[\\`*|]|_(?!\w))"
)


def rst_inline(text: str) -> str:
    """Code, links and stresses as reStructuredText writes them, and its other signs as letters."""
    return _MARKUP.sub(_rst_markup, text)


def _rst_markup(found: re.Match[str]) -> str:
    if found["sign"]:
        return f"\\{found['sign']}"
    if found["code"]:
        written = f"``{found['code'].strip()}``"
    elif found["label"]:
        written = f"`{found['label'].replace('`', '')} <{found['address']}>`__"
    else:
        written = f"{found['stars']}{found['stressed']}{found['stars']}"
    before, after = found.string[: found.start()][-1:], found.string[found.end() :][:1]
    # A markup ends at a space or a sign; a backslash before a space is neither seen nor a letter.
    return f"{_parted(before)}{written}{_parted(after)}"


def _parted(neighbour: str) -> str:
    return "\\ " if neighbour.isalnum() else ""


def files(root: Path, address: str) -> dict[str, str]:
    """The files, by name, as they should be."""
    number = version(root)
    changelog = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    date, _ = released(changelog, number)
    package = (root / "package.xml").read_text(encoding="utf-8")
    package = replaced(r"^  <version>(.+)</version>$", number, package, "package.xml")
    package = replaced(r'<maintainer email="(.*?)"', address, package, "package.xml")
    citation = (root / "CITATION.cff").read_text(encoding="utf-8")
    citation = replaced(r"^version: (.+)$", number, citation, "CITATION.cff")
    citation = replaced(r"^date-released: (.+)$", date, citation, "CITATION.cff")
    return {"package.xml": package, "CITATION.cff": citation, "CHANGELOG.rst": rst(changelog)}


def main() -> int:
    """Write the files, or say which are not as they should be."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail where a file would change")
    parser.add_argument("--maintainer", metavar="ADDRESS", help="the maintainer's address for package.xml")
    parser.add_argument("--notes", action="store_true", help="print the changes of the version only")
    parser.add_argument("--root", type=Path, default=ROOT, help="the checkout (default: this one)")
    arguments = parser.parse_args()
    root: Path = arguments.root
    address = arguments.maintainer or maintainer(root)
    if not re.fullmatch(r"[^@\s<>\"&]+@[^@\s<>\"&]+\.[^@\s<>\"&.]+", address):
        sys.exit(f"{address}: error: it is no address; write it as in name@example.org")
    if arguments.notes:
        print(released((root / "CHANGELOG.md").read_text(encoding="utf-8"), version(root))[1])
        return 0
    stale = {
        name: text
        for name, text in files(root, address).items()
        if not (root / name).is_file() or (root / name).read_text(encoding="utf-8") != text
    }
    if arguments.check:
        for name in stale:
            print(
                f"{name}: error: it is not what the version and CHANGELOG.md say; run make docs",
                file=sys.stderr,
            )
        return 1 if stale else 0
    for name, text in stale.items():
        (root / name).write_text(text, encoding="utf-8")
        print(name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
