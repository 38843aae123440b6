// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ListedIncident } from "../api/types";
import { href } from "../route";
import { ColumnHeads } from "../ui/column_heads";
import { NeedsServer } from "../ui/server_gone";
import { SizeCell, SUMMARY_COLUMNS, SummaryCells } from "./summary_cells";

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
          <button type="button" class="small" onClick={() => remove(one)}>
            Delete
          </button>
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
