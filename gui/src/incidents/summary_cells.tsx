// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { IncidentSummary } from "../api/types";
import { sizeWords } from "../ui/numbers";
import { ago, moment } from "../ui/times";
import { briefly, windowWords } from "./missing_words";

export const SUMMARY_COLUMNS = ["Incident", "When", "Rule", "Kept", "Size", "Missing"];

/** What the rows of all incidents say after its name, here and on robots. */
export function SummaryCells({ summary, size_kb }: { summary: IncidentSummary; size_kb: number }) {
  const { rule, triggered_ms, missing } = summary;
  return (
    <>
      <td data-label="When">
        <time title={ago(triggered_ms, Date.now())}>{moment(triggered_ms)}</time>
      </td>
      <td data-label="Rule">{rule}</td>
      <td data-label="Kept">{windowWords(summary)}</td>
      <SizeCell size_kb={size_kb} />
      <td data-label="Missing">
        {missing.length === 0 ? <span class="well">nothing</span> : <span class="trouble">{briefly(missing)}</span>}
      </td>
    </>
  );
}

export function SizeCell({ size_kb }: { size_kb: number }) {
  return (
    <td data-label="Size" class="number">
      {sizeWords(size_kb)}
    </td>
  );
}
