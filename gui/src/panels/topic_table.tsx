// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import { TIERS } from "../api/types";
import type { ProfileEditor } from "../state/profile_editor";
import { type DraftRow, isNumber, type NumberField, tableCells } from "../state/topic_rows";
import { Button } from "../ui/button";
import { useWindowEvent } from "../ui/watch";

/** The thesis's table of topic parameters, filled by hand or pasted from a spreadsheet. */
export function TopicTable({ editor }: { editor: ProfileEditor }) {
  const problems = editor.problems.value;
  usePastedTable(editor);
  return (
    <>
      <div class="row budget">
        <label>
          Budget: total bandwidth (KB/s)
          <input
            inputMode="decimal"
            value={editor.budget.value}
            placeholder="15000"
            aria-invalid={!isNumber(editor.budget.value)}
            onInput={(event) => editor.setBudget(event.currentTarget.value)}
          />
        </label>
        <p class="quiet">1 KB is 1000 bytes. A table copied from a spreadsheet can be pasted here.</p>
      </div>
      <div class="table-scroll">
        <table class="topic-table">
          <TableHead />
          <tbody>
            {editor.rows.value.map((row, index) => (
              <TopicRow key={row.key} editor={editor} row={row} number={index + 1} />
            ))}
          </tbody>
        </table>
      </div>
      <Button label="Add topic" onClick={() => editor.addRow()} />
      <ul class="problems" aria-label="Problems" aria-live="polite">
        {problems.map((problem) => (
          <li key={problem} class="problem">
            {problem}
          </li>
        ))}
      </ul>
    </>
  );
}

function TableHead() {
  return (
    <thead>
      <tr>
        <th scope="col">Topic</th>
        <th scope="col">Message size (KB)</th>
        {TIERS.map((tier) => (
          <th key={tier} scope="col">
            {tier} (Hz)
          </th>
        ))}
        <th scope="col">Priority</th>
        <th scope="col">Source (Hz)</th>
        <th scope="col">
          <span class="visually-hidden">Remove</span>
        </th>
      </tr>
    </thead>
  );
}

interface RowProps {
  editor: ProfileEditor;
  row: DraftRow;
  number: number;
}

/** A row, drawn anew only where it changed: a table may have many. */
function TopicRow({ editor, row, number }: RowProps) {
  return useMemo(() => <TopicCells {...{ editor, row, number }} />, [editor, row, number]);
}

function TopicCells({ editor, row, number }: RowProps) {
  const of = row.topic || `row ${number}`;
  const cell = (label: string, value: string, change: (text: string) => Partial<DraftRow>, placeholder = "") => (
    <td>
      <input
        inputMode="decimal"
        aria-label={`${label} of ${of}`}
        aria-invalid={!isNumber(value)}
        value={value}
        placeholder={placeholder}
        onInput={(event) => editor.change(row.key, change(event.currentTarget.value))}
      />
    </td>
  );
  const field = (name: NumberField) => (text: string) => ({ [name]: text });
  return (
    <tr>
      <th scope="row">
        <input
          class="topic"
          aria-label={`Topic of row ${number}`}
          value={row.topic}
          title={row.topic}
          placeholder="/topic"
          spellcheck={false}
          onInput={(event) => editor.change(row.key, { topic: event.currentTarget.value })}
          onPaste={(event) => pasteTable(event, editor, row.key)}
        />
      </th>
      {cell("Message size (KB)", row.message_kb, field("message_kb"))}
      {TIERS.map((tier, index) =>
        cell(`${tier} (Hz)`, row.tiers_hz[index] ?? "", (text) => ({ tiers_hz: row.tiers_hz.with(index, text) })),
      )}
      {cell("Priority", row.priority, field("priority"), "1")}
      {cell("Source (Hz)", row.source_hz, field("source_hz"))}
      <td>
        <Button label="−" class="small" aria-label={`Remove ${of}`} onClick={() => editor.removeRow(row.key)} />
      </td>
    </tr>
  );
}

/** Takes a pasted table from a row on, or with null each line where its topic is; other text is left to the browser. */
function pasteTable(event: ClipboardEvent, editor: ProfileEditor, key: number | null): void {
  const cells = tableCells(event.clipboardData?.getData("text/plain") ?? "");
  if (cells.length === 0 || event.defaultPrevented) return;
  event.preventDefault();
  editor.paste(key, cells);
}

/** Takes a table that is pasted anywhere on the page, but into no field. */
function usePastedTable(editor: ProfileEditor): void {
  useWindowEvent("paste", (event) => {
    const isField = event.target instanceof Element && event.target.closest("input, select, dialog") !== null;
    if (!isField) pasteTable(event, editor, null);
  });
}
