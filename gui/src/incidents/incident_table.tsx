// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { IncidentSummary, ListedIncident } from "../api/types";
import { href } from "../route";
import { Button } from "../ui/button";
import { ColumnHeads } from "../ui/data_table";
import { sizeWords } from "../ui/numbers";
import { NeedsServer } from "../ui/server_gone";
import { ago, moment } from "../ui/times";
import { briefly, windowWords } from "./missing_words";

export const SUMMARY_COLUMNS = ["Incident", "When", "Rule", "Kept", "Size", "Missing"];
const COLUMNS = [...SUMMARY_COLUMNS, "Folder"];

/** A row for each incident, the newest first; on a narrow screen a card. One that cannot be read says why. */
export function IncidentTable({ incidents, remove }: { incidents: readonly ListedIncident[]; remove: Remove }) {
  return (
    <div class="table-scroll">
      <table class="robot-table incident-table" aria-label="Incidents">
        <ColumnHeads names={COLUMNS} />
        <tbody>
          {incidents.map((one) =>
            one.summary === null ? (
              <BadRow key={one.name} {...{ one, remove }} />
            ) : (
              <IncidentRow key={one.name} one={one} summary={one.summary} />
            ),
          )}
        </tbody>
      </table>
    </div>
  );
}

type Remove = (incident: ListedIncident) => void;

function IncidentRow({ one, summary }: { one: ListedIncident; summary: NonNullable<ListedIncident["summary"]> }) {
  const { title, is_read } = summary;
  return (
    <tr class={is_read ? "" : "unread"}>
      <th scope="row">
        <a href={href({ page: "incidents", name: one.name })}>{title}</a>
        {!is_read && <span class="tag">not read</span>}
      </th>
      <SummaryCells summary={summary} size_kb={one.size_kb} />
      <td data-label="Folder" class="path">
        {folderOf(one.name)}
      </td>
    </tr>
  );
}

function BadRow({ one, remove }: { one: ListedIncident; remove: Remove }) {
  return (
    <tr class="silent">
      <th scope="row">{one.name.slice(one.name.lastIndexOf("/") + 1)}</th>
      <td data-label="Problem" colSpan={3}>
        <span class="trouble">Cannot be read: {one.problem}</span>
      </td>
      <SizeCell size_kb={one.size_kb} />
      <td data-label="">
        <NeedsServer changes>
          <Button label="Delete" class="small" onClick={() => remove(one)} />
        </NeedsServer>
      </td>
      <td data-label="Folder" class="path">
        {folderOf(one.name)}
      </td>
    </tr>
  );
}

function folderOf(name: string): string {
  return name.includes("/") ? name.slice(0, name.lastIndexOf("/")) : "the project";
}

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
