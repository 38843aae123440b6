// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { LevelledProperty, LevelsAnswer, ProfileRow } from "../api/types";
import { numberProblem, typedNumber } from "../ui/numbers";

export const TIER_COUNT = 6;

/** A row as it is being typed: texts, since half a number is not a number yet. */
export interface DraftRow extends TypedRow {
  key: number;
  type: string | null;
  accuracies: Accuracies;
  /** False while its size and rate are from a preset. */
  measured: boolean | null;
}
export type NumberField = "message_kb" | "priority" | "source_hz" | "min_hz" | "max_hz";

/** The number in a cell; null where it is empty, NaN where it is none. */
export const toNumber = (text: string) => (text.trim() === "" ? null : typedNumber(text));
/** Whether a cell holds a number that can be saved; an empty one is "not given". */
export const isNumber = (text: string) => {
  const value = toNumber(text);
  return value === null || (Number.isFinite(value) && value >= 0);
};

function cellProblem(cell: string): string {
  return numberProblem(cell) || `${cell.trim()} is less than 0`;
}

/** What keeps a table of topic parameters from being saved, in sentences. */
export function problemsOf(rows: readonly DraftRow[], budget: string): string[] {
  const problems = isNumber(budget) ? [] : [`The budget, the total bandwidth: ${cellProblem(budget)}.`];
  for (const row of rows) {
    const place = row.topic || "A row without a topic";
    const cells = [row.message_kb, row.priority, row.source_hz, row.min_hz, row.max_hz, ...row.tiers_hz];
    const wrong = cells.find((cell) => !isNumber(cell));
    if (wrong !== undefined) problems.push(`${place}: ${cellProblem(wrong)}.`);
    const isGiven = cells.some((cell) => cell.trim() !== "") || Object.values(row.accuracies).some(Boolean);
    if (row.topic.trim() === "" && isGiven) {
      problems.push("A row with numbers has no topic: name its topic, or remove it.");
    }
    const given = row.tiers_hz.filter((tier) => tier.trim() !== "").length;
    if (given !== 0 && given !== TIER_COUNT) problems.push(`${place}: give all six levels, or none.`);
  }
  const names = rows.map((row) => row.topic.trim()).filter(Boolean);
  for (const name of new Set(names)) {
    if (names.filter((each) => each === name).length > 1) problems.push(`${name} is in two rows.`);
  }
  return problems;
}

export type Six = LevelsAnswer["tiers_hz"];
type TiersKey = "tiers_m" | "tiers_deg" | "tiers_rad";
type NeedsKey = `${TiersKey}_need_hz`;
/** The accuracies of a topic's levels and the rates that they need, by the profile's keys. */
export type Accuracies = Record<TiersKey | NeedsKey, Six | null>;

/** What can have levels of accuracy, with the unit of its key. */
export const ACCURACY_UNITS: Record<LevelledProperty, "m" | "deg" | "rad"> = {
  position: "m",
  orientation: "deg",
  positions: "rad",
};
const KEYS = Object.values(ACCURACY_UNITS).flatMap((unit) => keysOf(unit));

export function keysOf(unit: "m" | "deg" | "rad"): [tiers: TiersKey, needs: NeedsKey] {
  return [`tiers_${unit}`, `tiers_${unit}_need_hz`];
}

export function accuraciesOf(row: Partial<ProfileRow>): Accuracies {
  return Object.fromEntries(KEYS.map((key) => [key, row[key] ?? null])) as Accuracies;
}

/** Whether `value`, of a draft that was kept, can be edited as accuracies. */
export function areAccuracies(value: unknown): value is Accuracies {
  if (typeof value !== "object" || value === null) return false;
  const given = value as Record<string, unknown>;
  return KEYS.every((key) => given[key] === null || isSix(given[key]));
}

function isSix(value: unknown): boolean {
  return Array.isArray(value) && value.length === 6 && value.every((each) => typeof each === "number");
}

export function sixOf([a, b, c, d, e, f]: readonly (number | null)[]): Six | null {
  const isWhole = a != null && b != null && c != null && d != null && e != null && f != null;
  return isWhole ? [a, b, c, d, e, f] : null;
}

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

/** The rows with those of a preset: of topics without a number, in whatever namespace, and of topics that are new. */
export function withPreset(rows: readonly DraftRow[], preset: readonly DraftRow[]): DraftRow[] {
  const isOf = (row: DraftRow, { topic }: DraftRow) => row.topic.trim().endsWith(topic);
  const own = rows
    .filter((row) => row.topic.trim() !== "" || !isWaiting(row))
    .map((row) => {
      const usual = isWaiting(row) ? preset.find((each) => isOf(row, each)) : undefined;
      return usual === undefined ? row : { ...usual, topic: row.topic, key: row.key };
    });
  return [...own, ...preset.filter((each) => !own.some((row) => isOf(row, each)))];
}

/** Whether nobody has given a number of the topic yet. */
function isWaiting(row: TypedRow): boolean {
  const cells = [row.message_kb, row.priority, row.source_hz, row.min_hz, row.max_hz, ...row.tiers_hz];
  return cells.every((cell) => cell.trim() === "");
}
