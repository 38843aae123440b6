# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Standard output and standard error that are closed, full, or have lost their reader."""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress
from typing import TextIO, cast

_OF_A_STREAM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF})


def open_closed_streams() -> None:
    """Give a process that was started without them an output that refuses, and errors that go nowhere."""
    if cast("TextIO | None", sys.stdout) is None:
        # Only for reading, so that what is written fails with the system's own words.
        sys.stdout = os.fdopen(os.open(os.devnull, os.O_RDONLY), "w")
    if cast("TextIO | None", sys.stderr) is None:
        sys.stderr = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")


def is_of_a_stream(error: OSError) -> bool:
    """Whether ``error`` is what printing raises: it has no file's name."""
    return error.filename is None and error.errno in _OF_A_STREAM


def forget_output() -> None:
    """Whatever Python still writes to standard output at the end must not complain."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
