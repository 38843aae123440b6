# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator's picture of one field was off by."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorSize:
    """How large an error was over time, in the field's unit.

    ``rmse`` is the root of the mean square over time, ``maximum`` the largest magnitude. The relative ones
    are shares of the field's range (0.02 is 2 %), ``None`` where the field never changed.
    """

    rmse: float
    maximum: float
    relative_rmse: float | None
    relative_maximum: float | None

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "rmse": self.rmse,
            "max": self.maximum,
            "relative_rmse": self.relative_rmse,
            "relative_max": self.relative_maximum,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldError:
    """The error of who holds the last value received, and of who interpolates between those received."""

    hold: ErrorSize
    interpolated: ErrorSize

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {"hold": self.hold.to_json(), "interpolated": self.interpolated.to_json()}


def error_columns(error: FieldError | None) -> dict[str, object]:
    """The columns of an error in ``--csv``, empty where there is none."""
    return {
        f"{way}_{key}": size.to_json()[key] if size else None
        for way, size in (
            ("hold", error.hold if error else None),
            ("interpolated", error.interpolated if error else None),
        )
        for key in ("rmse", "max", "relative_rmse", "relative_max")
    }
