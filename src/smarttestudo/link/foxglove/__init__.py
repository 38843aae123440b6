# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Foxglove app: the only importer of its SDK, which must be installed where this is called."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from smarttestudo.domain.errors import Extra, MissingPackageError, how_to_install

if TYPE_CHECKING:
    from smarttestudo.link.foxglove.sink import FoxgloveSink


def open_foxglove_sink(
    port: int, warn: Callable[[str], None], now_ns: Callable[[], int], *, host: str = "127.0.0.1"
) -> FoxgloveSink:
    """A sink that serves what it takes at ``host`` and ``port``; 0 takes a free one.

    Raises:
        MissingPackageError: the SDK is not installed.
        PortError: it cannot listen there.
    """
    try:
        from smarttestudo.link.foxglove.sink import FoxgloveSink  # noqa: PLC0415  see above
    except ModuleNotFoundError as error:
        if error.name != "foxglove":
            raise
        cause = "serving the Foxglove app needs the package foxglove-sdk"
        raise MissingPackageError(cause, remedy=how_to_install(Extra.LINK)) from error
    return FoxgloveSink(port, warn, now_ns, host=host)
