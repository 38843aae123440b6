// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type BoundNeed, TIERS } from "../api/types";
import { readable } from "../ui/numbers";
import { needOf } from "./needs";

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
        <table class="try-table curve-table" aria-label="What the levels need">
          <thead>
            <tr>
              <th scope="col">Level</th>
              <th scope="col">Accuracy ({unit})</th>
              <th scope="col">Messages per s</th>
              <th scope="col">Known from</th>
            </tr>
          </thead>
          <tbody>
            {TIERS.map((tier, index) => (
              <tr key={tier}>
                <th scope="row">
                  α{index} {tier}
                </th>
                <td class="number">{readable(levels[index] ?? 0)}</td>
                <td class="number">{props.needs_hz ? readable(props.needs_hz[index] ?? 0) : "–"}</td>
                <td>{origin(points, levels[index] ?? 0, props.needs_hz?.[index] ?? null)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {points && (
        <details>
          <summary>The curve as numbers</summary>
          <table class="try-table curve-table">
            <thead>
              <tr>
                <th scope="col">Accuracy ({unit})</th>
                <th scope="col">Messages per s, hold</th>
                <th scope="col">Messages per s, dead reckoning</th>
              </tr>
            </thead>
            <tbody>
              {points.map((point) => (
                <tr key={point.bound}>
                  <th scope="row">{readable(point.bound)}</th>
                  <td class="number">{readable(point.hold_hz)}</td>
                  <td class="number">{point.reckoned_hz === null ? "–" : readable(point.reckoned_hz)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </details>
      )}
    </>
  );
}

/** Where a need comes from: this recording, measured or between two bounds, or the profile as it was. */
function origin(points: readonly BoundNeed[] | null, bound: number, need_hz: number | null): string {
  if (need_hz === null) return "–";
  const need = points && needOf(points, bound);
  if (need?.hz !== need_hz) return "the profile";
  return need.isMeasured ? "measured at this bound" : "interpolated between two bounds";
}
