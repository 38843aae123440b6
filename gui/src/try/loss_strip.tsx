// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from "preact/hooks";
import type { TryFieldLoss } from "../api/types";
import type { Trial } from "../state/trial";
import { openStrip } from "./strip_plot";

/** The error of one value over time. */
export function LossStrip({ trial, field }: { trial: Trial; field: TryFieldLoss }) {
  const host = useRef<HTMLDivElement>(null);
  useEffect(
    () => (host.current ? openStrip(host.current, trial, { after: field.error_bins }) : undefined),
    [trial, field],
  );
  return (
    <figure class="strip" aria-label={`Error of ${field.topic} ${field.field}`}>
      <figcaption class="quiet">Largest error in each stretch of time ({field.unit || "in its own unit"})</figcaption>
      <div ref={host} class="strip-plot" />
    </figure>
  );
}
