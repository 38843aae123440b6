// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Curve } from "../api/types";
import { readable } from "../ui/numbers";

const shown = (value: number | null) => (value === null ? "–" : readable(value));

/** The curve as numbers, for who cannot see it or wants them. */
export function CurveTable({ curve }: { curve: Curve }) {
  return (
    <details>
      <summary>The curve as numbers</summary>
      <table class="try-table curve-table">
        <thead>
          <tr>
            <th scope="col">Rate (Hz)</th>
            <th scope="col">Error, RMSE (% of the range)</th>
            <th scope="col">of</th>
            <th scope="col">Mean age (s)</th>
            <th scope="col">Bandwidth (KB/s)</th>
          </tr>
        </thead>
        <tbody>
          {curve.points.map((point) => (
            <tr key={point.rate_hz}>
              <th scope="row">{readable(point.rate_hz)}</th>
              <td class="number">{shown(point.error_percent)}</td>
              <td>{point.worst_field ?? "–"}</td>
              <td class="number">{shown(point.age_mean_s)}</td>
              <td class="number">{readable(point.kb_per_s)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </details>
  );
}
