// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A row of the table of topic parameters, as texts. */
export interface TypedRow {
  topic: string;
  message_kb: string;
  tiers_hz: string[];
  priority: string;
  source_hz: string;
  min_hz: string;
  max_hz: string;
}

/** The cells of a table that was copied from a spreadsheet, without a line of titles; empty for other text. */
export function tableCells(text: string): string[][] {
  if (!text.includes("\t")) return [];
  const lines = text.split(/\r?\n/).map((line) => line.split("\t").map((cell) => cell.trim()));
  const filled = lines.filter(([topic]) => topic !== "");
  return filled.length > 1 && areTitles(filled[0] ?? []) ? filled.slice(1) : filled;
}

/** Whether these cells name columns: a topic may come without a number as well. */
function areTitles([first = "", ...others]: readonly string[]): boolean {
  const hasDigit = [first, ...others].some((cell) => /\d/.test(cell));
  return !hasDigit && !first.startsWith("/") && others.some((cell) => cell !== "");
}

/**
 * The rows with pasted cells: topic, KB, six levels, priority, source rate.
 *
 * They go into the row `from` and those below it; with null into the rows of their topics, else into empty and new
 * ones. A row that only waits for the numbers of a topic goes where another one has them now.
 */
export function withPasted<Row extends TypedRow>(
  rows: readonly Row[],
  from: number | null,
  lines: readonly string[][],
  empty: () => Row,
): Row[] {
  const all = [...rows];
  const filled = new Set<Row>();
  lines.forEach((cells, index) => {
    const place = from === null ? placeOf(all, cells[0] ?? "") : from + index;
    const row = withCells(all[place] ?? empty(), cells);
    all[place] = row;
    filled.add(row);
  });
  const topics = new Set([...filled].map(({ topic }) => topic));
  return all.filter((row) => filled.has(row) || !(topics.has(row.topic.trim()) && isWaiting(row)));
}

function placeOf(rows: readonly TypedRow[], topic: string): number {
  const known = rows.findIndex((row) => row.topic.trim() === topic);
  if (known >= 0) return known;
  const free = rows.findIndex((row) => row.topic.trim() === "" && isWaiting(row));
  return free >= 0 ? free : rows.length;
}

function withCells<Row extends TypedRow>(row: Row, [topic = "", size = "", ...numbers]: readonly string[]): Row {
  const count = row.tiers_hz.length;
  return {
    ...row,
    topic,
    message_kb: size,
    tiers_hz: row.tiers_hz.map((tier, at) => numbers[at] ?? tier),
    priority: numbers[count] ?? row.priority,
    source_hz: numbers[count + 1] ?? row.source_hz,
  };
}

/** Whether nobody has given a number of the topic yet. */
function isWaiting(row: TypedRow): boolean {
  const cells = [row.message_kb, row.priority, row.source_hz, row.min_hz, row.max_hz, ...row.tiers_hz];
  return cells.every((cell) => cell.trim() === "");
}
