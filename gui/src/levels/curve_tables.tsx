// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type BoundNeed, type Curve, TIERS } from "../api/types";
import { DataTable } from "../ui/data_table";
import { readable } from "../ui/numbers";

const CURVE = "try-table curve-table";

/** The curve of an accuracy and its levels as numbers. */
export function AccuracyTables(props: {
  unit: string;
  levels: readonly number[] | null;
  needs_hz: readonly number[] | null;
  points: readonly BoundNeed[] | null;
}) {
  const { unit, levels, points } = props;
  return (
    <>
      {levels && (
        <DataTable
          class={CURVE}
          label="What the levels need"
          heads={["Level", `Accuracy (${unit})`, "Messages per s", "Known from"]}
          words={[3]}
          rows={TIERS.map((tier, index) => [
            `α${index} ${tier}`,
            readable(levels[index] ?? 0),
            props.needs_hz ? readable(props.needs_hz[index] ?? 0) : "–",
            origin(points, levels[index] ?? 0, props.needs_hz?.[index] ?? null),
          ])}
        />
      )}
      {points && (
        <details>
          <summary>The curve as numbers</summary>
          <DataTable
            class={CURVE}
            heads={[`Accuracy (${unit})`, "Messages per s, hold", "Messages per s, dead reckoning"]}
            rows={points.map(({ bound, hold_hz, reckoned_hz }) => [
              readable(bound),
              readable(hold_hz),
              shown(reckoned_hz),
            ])}
          />
        </details>
      )}
    </>
  );
}

const shown = (value: number | null) => (value === null ? "–" : readable(value));

/** The curve of rates as numbers. */
export function CurveTable({ curve }: { curve: Curve }) {
  return (
    <details>
      <summary>The curve as numbers</summary>
      <DataTable
        class={CURVE}
        heads={["Rate (Hz)", "Error, RMSE (% of the range)", "of", "Mean age (s)", "Bandwidth (KB/s)"]}
        words={[2]}
        rows={curve.points.map(({ rate_hz, error_percent, worst_field, age_mean_s, kb_per_s }) => [
          readable(rate_hz),
          shown(error_percent),
          worst_field ?? "–",
          shown(age_mean_s),
          readable(kb_per_s),
        ])}
      />
    </details>
  );
}

/** Where a need comes from: this recording, measured or between two bounds, or the profile as it was. */
function origin(points: readonly BoundNeed[] | null, bound: number, need_hz: number | null): string {
  if (need_hz === null) return "–";
  const need = points && needOf(points, bound);
  if (need?.hz !== need_hz) return "the profile";
  return need.isMeasured ? "measured at this bound" : "interpolated between two bounds";
}

const DIGITS = 3;

interface Need {
  hz: number;
  isMeasured: boolean;
}

/**
 * The messages per s that `bound` needs with hold; `points` are measured, the widest first.
 *
 * Between two bounds it is on the line between theirs, above the widest on that of it; null below the tightest.
 */
export function needOf(points: readonly BoundNeed[], bound: number): Need | null {
  for (const [index, point] of points.entries()) {
    if (bound === point.bound) return { hz: inRound(point.hold_hz), isMeasured: true };
    if (bound < point.bound) continue;
    const wider = points[index - 1];
    if (!wider) return { hz: inRound(point.hold_hz), isMeasured: false };
    const share = (bound - point.bound) / (wider.bound - point.bound);
    return { hz: inRound(point.hold_hz + (wider.hold_hz - point.hold_hz) * share), isMeasured: false };
  }
  return null;
}

function inRound(rate_hz: number): number {
  return Number(rate_hz.toPrecision(DIGITS));
}
