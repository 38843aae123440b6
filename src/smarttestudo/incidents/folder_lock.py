# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One run at a time has a folder."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

from smarttestudo.files.whole_file import OutputFileError, not_written

LOCK_NAME = ".lock"


class FolderLock:
    """``folder``, which is made where there is none, until ``release`` or the end of the process.

    ``option`` is what names it.

    Raises ``OutputFileError`` where it cannot be made, or another run has it: completing what a killed run
    left would cut the files of one that lives.
    """

    def __init__(self, folder: Path, option: str) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(folder / LOCK_NAME, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise not_written(folder, f"the folder of {option}", error) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(self._file)
            remedy = f"name another folder with {option}"
            raise OutputFileError("another run records here", place=str(folder), remedy=remedy) from error
        except OSError:
            # A disk that knows no locks.
            return

    def release(self) -> None:
        """Let another run have it."""
        os.close(self._file)
