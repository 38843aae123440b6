# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A cluster that the tests of this folder share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from fleet.dask_processes import DaskProcesses, dask_processes


@pytest.fixture(scope="session")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskProcesses]:
    """Two workers, which tests leave as they are."""
    with dask_processes(tmp_path_factory.mktemp("dask")) as started:
        yield started
