// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ListedIncident } from "../api/types";
import { href } from "../route";
import { ColumnHeads } from "../ui/column_heads";
import { ago, moment } from "../ui/times";
import { briefly, sizeWords, windowWords } from "./missing_words";

const COLUMNS = ["Incident", "When", "Rule", "Kept", "Size", "Missing", "Folder"];

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
  const { title, rule, triggered_ms, missing, is_read } = summary;
  return (
    <tr class={is_read ? "" : "unread"}>
      <th scope="row">
        <a href={href({ page: "incidents", name: one.name })}>{title}</a>
        {!is_read && <span class="tag">not read</span>}
      </th>
      <td data-label="When">
        <time title={ago(triggered_ms, Date.now())}>{moment(triggered_ms)}</time>
      </td>
      <td data-label="Rule">{rule}</td>
      <td data-label="Kept">{windowWords(summary)}</td>
      <td data-label="Size" class="number">
        {sizeWords(one.size_kb)}
      </td>
      <td data-label="Missing">
        {missing.length === 0 ? <span class="well">nothing</span> : <span class="trouble">{briefly(missing)}</span>}
      </td>
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
      <td data-label="Size" class="number">
        {sizeWords(one.size_kb)}
      </td>
      <td data-label="">
        <button type="button" class="small" onClick={() => remove(one)}>
          Delete
        </button>
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
