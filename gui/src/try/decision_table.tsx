// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Trial } from "../state/trial";
import { Button } from "../ui/button";
import { hz } from "../ui/numbers";

/** Every decision; a time leads there. */
export function DecisionTable({ trial }: { trial: Trial }) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => (box.current ? followTime(box.current, trial) : undefined), [trial]);
  const { decisions, decision_count } = trial.answer;
  return (
    <section aria-label="Decisions">
      <h3>Decisions{decision_count > decisions.length && ` (the first ${decisions.length} of ${decision_count})`}</h3>
      <div class="decision-box" ref={box}>
        <table class="try-table">
          <thead>
            <tr>
              <th scope="col">Time (s)</th>
              <th scope="col">Topic</th>
              <th scope="col">From</th>
              <th scope="col">To</th>
              <th scope="col">Because of</th>
            </tr>
          </thead>
          <tbody>
            {decisions.map((decision, index) => (
              <tr key={index}>
                <td class="number">
                  <Button label={decision.t.toFixed(1)} class="link" onClick={() => trial.goTo(decision.t)} />
                </td>
                <td>{decision.topic}</td>
                <td class="number">{decision.start ? "–" : hz(decision.from_hz ?? null)}</td>
                <td class="number">{hz(decision.to_hz)}</td>
                <td>{[decision.rule ?? decision.reason, ...decision.bounds].join("; ")}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

/** Marks the decisions that rates come from now, and keeps the latest of them in sight. */
function followTime(box: HTMLElement, trial: Trial): () => void {
  const { decisions } = trial.answer;
  const rows = [...box.querySelectorAll<HTMLElement>("tbody tr")];
  let marked: HTMLElement[] = [];
  return effect(() => {
    const valid = new Set(trial.plan.value.values());
    for (const row of marked) row.removeAttribute("aria-current");
    marked = rows.filter((_, index) => valid.has(decisions[index] as (typeof decisions)[number]));
    for (const row of marked) row.setAttribute("aria-current", "time");
    const last = marked.at(-1);
    if (last) box.scrollTop = last.offsetTop - box.clientHeight / 2;
  });
}
