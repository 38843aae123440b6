// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ListedIncident, RemoteIncident } from "../api/types";
import { href } from "../route";
import { Button } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { ColumnHeads } from "../ui/data_table";
import { baseName, folderOf } from "../ui/files";
import { ago, counted, moment, NS_PER_MS, sizeWords } from "../ui/numbers";
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
            one.incident === null ? (
              <BadRow key={one.name} {...{ one, remove }} />
            ) : (
              <IncidentRow key={one.name} name={one.name} incident={one.incident} />
            ),
          )}
        </tbody>
      </table>
    </div>
  );
}

type Remove = (incident: ListedIncident) => void;

function IncidentRow({ name, incident }: { name: string; incident: RemoteIncident }) {
  const { label, is_read } = incident;
  return (
    <tr class={is_read ? "" : "unread"}>
      <th scope="row">
        <a href={href({ page: "incidents", name })}>{label}</a>
        {!is_read && <span class="tag">not read</span>}
      </th>
      <SummaryCells incident={incident} />
      <td data-label="Folder" class="path">
        {folderWords(name)}
      </td>
    </tr>
  );
}

function BadRow({ one, remove }: { one: ListedIncident; remove: Remove }) {
  return (
    <tr class="silent">
      <th scope="row">{baseName(one.name)}</th>
      <td data-label="Problem" colSpan={3}>
        <span class="trouble">Cannot be read: {one.problem}</span>
      </td>
      <SizeCell size_bytes={one.size_bytes} />
      <td data-label="">
        <NeedsServer changes>
          <Button label="Delete" class="small" onClick={() => remove(one)} />
        </NeedsServer>
      </td>
      <td data-label="Folder" class="path">
        {folderWords(one.name)}
      </td>
    </tr>
  );
}

function folderWords(name: string): string {
  return folderOf(name).replace(/\/$/, "") || "the project";
}

/** What the rows of all incidents say after its name, here and on robots. */
export function SummaryCells({ incident }: { incident: RemoteIncident }) {
  const triggeredMs = incident.triggered_ns / NS_PER_MS;
  const missing = briefly(incident.missing);
  return (
    <>
      <td data-label="When">
        <time title={ago(triggeredMs, Date.now())}>{moment(triggeredMs)}</time>
        {incident.moments > 1 && <span class="quiet"> and {counted(incident.moments - 1, "further moment")}</span>}
      </td>
      <td data-label="Rule">{incident.rule}</td>
      <td data-label="Kept">{windowWords(incident)}</td>
      <SizeCell size_bytes={incident.size_bytes} />
      <td data-label="Missing">
        {missing === "" ? <span class="well">nothing</span> : <span class="trouble">{missing}</span>}
      </td>
    </>
  );
}

function SizeCell({ size_bytes }: { size_bytes: number }) {
  return (
    <td data-label="Size" class="number">
      {sizeWords(size_bytes / 1000)}
    </td>
  );
}
