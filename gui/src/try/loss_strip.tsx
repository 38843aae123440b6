// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import type { TryFieldLoss } from "../api/types";
import type { Trial } from "../state/trial";
import { Strip } from "./strip";

/** The error of one value over time. */
export function LossStrip({ trial, field }: { trial: Trial; field: TryFieldLoss }) {
  const lines = useMemo(() => ({ after: field.error_bins }), [field]);
  return (
    <Strip timeline={trial} lines={lines} label={`Error of ${field.topic} ${field.field}`}>
      <span class="quiet">Largest error in each stretch of time ({field.unit || "in its own unit"})</span>
    </Strip>
  );
}
