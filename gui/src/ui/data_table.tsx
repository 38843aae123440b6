// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { Button } from "./button";

interface Props {
  heads: readonly string[];
  /** Cells in the order of the heads; the first one names its row. */
  rows: readonly (readonly ComponentChildren[])[];
  /** The numbers of columns that hold words. */
  words?: readonly number[];
  caption?: string;
  label?: string;
  class?: string;
  sort?: Sort;
  /** What tells rows apart that come and move. */
  keys?: readonly string[];
  /** The row below all others. */
  foot?: readonly ComponentChildren[];
}

/** The column that rows are sorted by, and how to sort them by another. */
interface Sort {
  column: number;
  isDown: boolean;
  by: (column: number) => void;
}

/** A table of numbers. */
export function DataTable(props: Props) {
  const { heads, rows, words = [], caption, label, class: look = "try-table", sort, keys, foot } = props;
  const line = ([name, ...cells]: readonly ComponentChildren[], key?: string | number) => (
    <tr key={key}>
      <th scope="row">{name}</th>
      {cells.map((cell, index) => (
        <td key={heads[index + 1]} class={words.includes(index + 1) ? undefined : "number"}>
          {cell}
        </td>
      ))}
    </tr>
  );
  return (
    <table class={look} aria-label={label}>
      {caption && <caption>{caption}</caption>}
      <ColumnHeads names={heads} sort={sort} />
      <tbody>
        {rows.map((row, index) => line(row, keys?.[index] ?? (typeof row[0] === "string" ? row[0] : index)))}
      </tbody>
      {foot && <tfoot>{line(foot)}</tfoot>}
    </table>
  );
}

/** The head of a table: a title for each column, and a button where rows can be sorted by it. */
export function ColumnHeads({ names, sort }: { names: readonly string[]; sort?: Sort | undefined }) {
  const sortedBy = (column: number) =>
    sort?.column === column ? (sort.isDown ? "descending" : "ascending") : undefined;
  return (
    <thead>
      <tr>
        {names.map((name, column) => (
          <th key={name} scope="col" aria-sort={sortedBy(column)}>
            {sort ? <Button label={name} class="sort" onClick={() => sort.by(column)} /> : name}
          </th>
        ))}
      </tr>
    </thead>
  );
}
