// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";

interface Props {
  heads: readonly string[];
  /** Cells in the order of the heads; the first one names its row. */
  rows: readonly (readonly ComponentChildren[])[];
  /** The numbers of columns that hold words. */
  words?: readonly number[];
  caption?: string;
  label?: string;
  class?: string;
}

/** A table of numbers. */
export function DataTable({ heads, rows, words = [], caption, label, class: look = "try-table" }: Props) {
  return (
    <table class={look} aria-label={label}>
      {caption && <caption>{caption}</caption>}
      <ColumnHeads names={heads} />
      <tbody>
        {rows.map(([name, ...cells], row) => (
          <tr key={typeof name === "string" ? name : row}>
            <th scope="row">{name}</th>
            {cells.map((cell, index) => (
              <td key={heads[index + 1]} class={words.includes(index + 1) ? undefined : "number"}>
                {cell}
              </td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** The head of a table: a title for each column. */
export function ColumnHeads({ names }: { names: readonly string[] }) {
  return (
    <thead>
      <tr>
        {names.map((name) => (
          <th key={name} scope="col">
            {name}
          </th>
        ))}
      </tr>
    </thead>
  );
}
