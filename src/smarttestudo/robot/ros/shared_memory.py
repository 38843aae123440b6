# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Room for large messages in the memory by which Fast DDS reaches the processes of its machine.

It is the sender's, and half a megabyte by default. A message of best effort that finds no room is lost.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from rclpy.utilities import get_rmw_implementation_identifier

from smarttestudo.files.removal import temporary_folder
from smarttestudo.robot.ros.discovery import environment, is_on_localhost, knows_ranges

PROFILE = Path(__file__).with_name("fastdds_large_messages.xml")
SEGMENT_BYTES = 16 * 1024 * 1024
"""As in the profile. Fast DDS takes it at once; it holds 17 images of 640 x 480 pixels, or two of 6 MB."""
LEAST_BYTES = 1024 * 1024
SHARE_OF_FREE = 4
_SHARED = Path("/dev/shm")  # noqa: S108 - no temporary file: the place of POSIX's shared memory
_MAY_BE_LOST = "of what is published here, messages of more than 64 KB may be lost"

PROFILES_FILE = "FASTDDS_DEFAULT_PROFILES_FILE"
PROFILES_FILE_BEFORE_KILTED = "FASTRTPS_DEFAULT_PROFILES_FILE"
_TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"
OF_USERS = (PROFILES_FILE, PROFILES_FILE_BEFORE_KILTED, _TRANSPORTS, "RMW_FASTRTPS_USE_QOS_FROM_XML")
"""Variables by which somebody configures Fast DDS, who then has that and nothing else."""
FILES_OF_USERS = ("DEFAULT_FASTDDS_PROFILES.xml", "DEFAULT_FASTRTPS_PROFILES.xml")
"""What it reads in the working directory."""


def is_fast_dds() -> bool:
    """Whether that is the middleware of this process."""
    identifier: str = get_rmw_implementation_identifier()
    return identifier.startswith("rmw_fastrtps")


@contextmanager
def room_for_large_messages() -> Iterator[str | None]:
    """Have room in the memory of the participant that is made in the block, the first one of this process.

    What a user configures stays as it is, and so does how far nodes are discovered. The block is given the
    reason why there is no room, if so.
    """
    if not is_fast_dds() or is_configured(os.environ):
        yield None
        return
    size_bytes = segment_bytes(_free_bytes())
    if size_bytes is None:
        yield f"{_SHARED} is nearly full; {_MAY_BE_LOST}"
        return
    with ExitStack() as opened:
        problem = None
        try:
            path = _profile(size_bytes, opened)
            opened.enter_context(environment({_profiles_file(): path}))
        except OSError as error:
            problem = f"no profile of Fast DDS can be written: {error}; {_MAY_BE_LOST}"
        yield problem


def is_configured(variables: Mapping[str, str]) -> bool:
    """Whether a user configures Fast DDS, by variables or by a file in the working directory."""
    return any(variables.get(name) for name in OF_USERS) or any(
        Path(name).exists() for name in FILES_OF_USERS
    )


def segment_bytes(free_bytes: int) -> int | None:
    """How much to share where so much is free; ``None`` where that is too little."""
    size_bytes = min(SEGMENT_BYTES, free_bytes // SHARE_OF_FREE)
    return size_bytes if size_bytes >= LEAST_BYTES else None


def senders_remedy() -> str:
    """Environment variable that gives the process of a node of this machine room for large messages."""
    if knows_ranges() and not is_on_localhost():
        return f"{_TRANSPORTS}='DEFAULT?sockets_size={SEGMENT_BYTES // 2 // 1024 // 1024}MB'"
    # Humble's Fast DDS does not read that, and others do not where nodes stay on their machine.
    return f"{_profiles_file()}={PROFILE}"


def _profile(size_bytes: int, opened: ExitStack) -> str:
    """A file with the profile, or one for less memory, which is there until ``opened`` is closed."""
    if size_bytes == SEGMENT_BYTES:
        return str(PROFILE)
    folder = opened.enter_context(temporary_folder(prefix="testudo-"))
    text = PROFILE.read_text(encoding="utf-8").replace(str(SEGMENT_BYTES), str(size_bytes))
    path = folder / PROFILE.name
    path.write_text(text, encoding="utf-8")
    return str(path)


def _free_bytes() -> int:
    try:
        return shutil.disk_usage(_SHARED).free
    except OSError:
        return 0


def _profiles_file() -> str:
    """The variable by the name of Fast DDS's library, which changed with version 3."""
    try:
        maps = Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return PROFILES_FILE_BEFORE_KILTED
    return PROFILES_FILE if "/libfastdds.so" in maps else PROFILES_FILE_BEFORE_KILTED
