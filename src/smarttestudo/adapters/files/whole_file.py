# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text files that appear under their name only when they are whole."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from smarttestudo.domain.errors import TestudoError


class OutputFileError(TestudoError):
    """A file that cannot be written."""


@contextmanager
def whole_file(path: Path, content: str) -> Iterator[Callable[[str], None]]:
    """What the block is given appends text; the file takes the place of ``path`` once the block ends well.

    ``content`` names what the file holds. Raises ``OutputFileError`` where it cannot be written, before the
    block if that is known by then.
    """
    with _errors_at(path, content):
        if path.is_dir():
            raise IsADirectoryError(None, "it is a folder")
        handle, name = tempfile.mkstemp(prefix=f".{path.name}-", suffix=".partial", dir=path.parent)
    workshop = Path(name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:

            def write(text: str) -> None:
                with _errors_at(path, content):
                    file.write(text)

            yield write
            with _errors_at(path, content):
                file.flush()
        with _errors_at(path, content):
            workshop.chmod(0o666 & ~_umask())
            workshop.replace(path)
    finally:
        with suppress(OSError):
            workshop.unlink(missing_ok=True)


@contextmanager
def _errors_at(path: Path, content: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        cause = f"{content} cannot be written: {error.strerror or error}"
        raise OutputFileError(cause, place=str(path), remedy="name another file") from error


def _umask() -> int:
    # There is no way to ask for it without setting it.
    mask = os.umask(0)
    os.umask(mask)
    return mask
