// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { SituationLoad } from "../api/types";
import { hz, kilobytes, readable } from "../ui/numbers";

/** What each topic takes of the link in one situation, as shares of the budget. */
export function SituationBars({ situation, budgetKbPerS }: { situation: SituationLoad; budgetKbPerS: number }) {
  const loads = [...situation.loads].sort((a, b) => b.kb_per_s - a.kb_per_s);
  const share = situation.kb_per_s / budgetKbPerS;
  const scale = Math.max(budgetKbPerS, situation.kb_per_s);
  return (
    <figure class={share > 1 ? "situation over" : "situation"}>
      <figcaption>
        <strong>{situation.title}</strong>
        <span class="quiet">
          {kilobytes(situation.kb_per_s)} KB/s, {readable(share * 100)} % of the budget
        </span>
      </figcaption>
      <meter min={0} max={1} value={Math.min(share, 1)} aria-label={`${situation.title}: share of the budget`} />
      <table>
        <thead class="visually-hidden">
          <tr>
            <th>Topic</th>
            <th>Share</th>
            <th>Rate</th>
            <th>KB/s</th>
          </tr>
        </thead>
        <tbody>
          {loads.map((load) => (
            <tr key={load.topic}>
              <th scope="row">{load.topic}</th>
              <td class="bar-cell" aria-hidden="true">
                <span class="load" style={{ width: `${(100 * load.kb_per_s) / scale}%` }} />
              </td>
              <td class="number">{hz(load.rate_hz)}</td>
              <td class="number">{kilobytes(load.kb_per_s)} KB/s</td>
            </tr>
          ))}
        </tbody>
      </table>
    </figure>
  );
}
