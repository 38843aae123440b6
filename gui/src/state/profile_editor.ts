// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";
import { type Api, ApiError } from "../api/client";
import type { Preset, ProfileRow, ProfileTable } from "../api/types";
import type { LocalDrafts } from "./drafts";
import { OpenFile } from "./open_file";
import {
  type Accuracies,
  accuraciesOf,
  areAccuracies,
  type DraftRow,
  problemsOf,
  sixOf,
  TIER_COUNT,
  toNumber,
  withPasted,
  withPreset,
} from "./topic_rows";

const CHECK_AFTER_MS = 400;
const shown = (value: number | null | undefined) => (value === null || value === undefined ? "" : String(value));

/** What the editor holds. */
interface Table {
  rows: readonly DraftRow[];
  budget: string;
  /** The profile that the rows are in: it has the types of topics and comments, which nobody types. */
  baseText: string;
}

const NOTHING: ProfileTable = { rows: [{ topic: "" }], budget_kb_per_s: null };

/** A table as text, in one order of its keys, so that equal tables are equal texts. */
function packed({ rows, budget, baseText }: Table): string {
  return JSON.stringify({ rows, budget, baseText });
}

/** The table of one profile. */
export class ProfileEditor extends OpenFile {
  private readonly table = signal<Table>({ rows: [], budget: "", baseText: "" });
  /** The rule file that the table is made for: it is checked with what is saved of it first. */
  readonly madeFor = signal<string | null>(null);
  readonly beside = computed(() => JSON.stringify({ madeFor: this.madeFor.value }));
  readonly rows = computed(() => this.table.value.rows);
  readonly budget = computed(() => this.table.value.budget);
  readonly content = computed(() => packed(this.table.value));
  /** Whether there is no file of this name yet. */
  readonly isNew = computed(() => this.isOpen.value && this.saved.value.hash === null);
  /** Why the server would not save the table. */
  private readonly refusal = signal("");
  readonly problems = computed(() => [
    ...problemsOf(this.rows.value, this.budget.value),
    ...(this.refusal.value ? [`${this.refusal.value}.`] : []),
  ]);
  private timer: number | undefined;
  private nextKey = 0;

  constructor(api: Api, name: string, drafts: LocalDrafts) {
    super(api, name, drafts);
  }

  protected override async contentOf(text: string | null): Promise<string> {
    const { rows, budget_kb_per_s }: ProfileTable =
      text === null ? NOTHING : await this.api.ask("POST /api/profile/parse", { name: this.name, text });
    const budget = shown(budget_kb_per_s);
    return packed({ rows: rows.map((row) => this.draftRow(row)), budget, baseText: text ?? "" });
  }

  protected override async written(): Promise<string> {
    const table = { ...this.finishedTable(), name: this.name, base_text: this.typesText };
    return (await this.api.ask("POST /api/profile/write", table)).text;
  }

  protected setContent(content: string): void {
    this.table.value = JSON.parse(content);
  }

  protected contentOfDraft(draft: string): string | null {
    const table = tableOf(draft);
    return table && packed({ ...table, rows: table.rows.map((row) => ({ ...row, key: this.nextKey++ })) });
  }

  protected setBeside(beside: string | null): void {
    // The rules that the address names come before those of the draft.
    this.madeFor.value ??= beside === null ? null : ownerOf(beside);
  }

  protected linesOf(content: string): string {
    const { rows, budget } = JSON.parse(content) as Table;
    const cells = rows.map((row) =>
      [row.topic, row.message_kb, ...row.tiers_hz, row.priority, row.source_hz].join("  "),
    );
    return [`budget_kb_per_s ${budget}`, ...cells].join("\n");
  }

  protected override asSaved(content: string, baseText: string): string {
    this.table.value = { ...this.table.value, baseText };
    return packed({ ...JSON.parse(content), baseText });
  }

  protected override async saveBeside(isNew: boolean): Promise<void> {
    if (isNew && this.madeFor.value !== null) await this.api.chooseProfile(this.madeFor.value, this.name);
  }

  override async open(isThere: boolean): Promise<void> {
    await super.open(isThere);
    if (!this.isSaved.value) await this.check();
  }

  /** Replaces the table by one measured in a bag. */
  async measure(bag: string, run: string, signal: AbortSignal): Promise<void> {
    const { text } = await this.api.ask("POST /api/profile/measure", { bag, run }, { signal });
    await this.replace(await this.contentOf(text));
  }

  /** Replaces the table by one measured on the robot for so many seconds. */
  async measureLive(seconds: number, run: string, signal: AbortSignal): Promise<void> {
    const { text } = await this.api.ask("POST /api/profile/measure-live", { seconds, run }, { signal });
    await this.replace(await this.contentOf(text));
  }

  /** Fills what nobody has given a number of, and adds topics, from a preset. */
  async fill({ title, text }: Preset): Promise<void> {
    const { rows } = await this.api.ask("POST /api/profile/parse", { name: this.name, text });
    this.remember();
    const usual = rows.map((row) => this.draftRow(row));
    // A new file has the preset's comments, which say where its numbers are from.
    this.put({ rows: withPreset(this.rows.value, usual), baseText: this.typesText || text });
    this.message.value = `Filled from ${title}: not measured`;
  }

  /** Looks at what may be another by now: the server was gone, and checked nothing. */
  async revive(): Promise<void> {
    await this.lookAtDisk();
    await this.check();
  }

  addRow(): void {
    this.remember();
    this.put({ rows: [...this.rows.value, this.draftRow({ topic: "" })] });
  }

  /** Begins a new table with rows for topics: nobody changed anything yet. */
  begin(topics: readonly string[]): void {
    this.table.value = { ...this.table.value, rows: topics.map((topic) => this.draftRow({ topic })) };
    this.saved.value = { ...this.saved.value, content: this.content.value };
    void this.check();
  }

  /** Adds rows for topics, in the place of rows without one. */
  addTopics(topics: readonly string[]): void {
    this.remember();
    const named = this.rows.value.filter((row) => row.topic.trim() !== "");
    this.put({ rows: [...named, ...topics.map((topic) => this.draftRow({ topic }))] });
  }

  removeRow(key: number): void {
    this.remember();
    this.put({ rows: this.rows.value.filter((row) => row.key !== key) });
  }

  /** A key stroke in a cell. */
  change(key: number, changes: Partial<DraftRow>): void {
    this.remember(performance.now());
    const isTyped = "message_kb" in changes || "source_hz" in changes;
    this.putRow(key, isTyped ? { ...changes, measured: null } : changes);
  }

  /** Sets the six levels of a row; what goes on, as a drag does, is one step of undo with what went before. */
  setTiers(key: number, tiersHz: readonly number[], goesOn: boolean): void {
    if (!goesOn) this.remember();
    this.putRow(key, { tiers_hz: tiersHz.map(shown) });
  }

  /** Sets accuracies of a row and the rates that they need, as `setTiers` does levels. */
  setAccuracies(key: number, changes: Partial<Accuracies>, goesOn: boolean): void {
    if (!goesOn) this.remember();
    const before = this.rows.value.find((row) => row.key === key);
    if (before) this.putRow(key, { accuracies: { ...before.accuracies, ...changes } });
  }

  setBudget(budget: string): void {
    this.remember(performance.now());
    this.put({ budget });
  }

  /** Takes cells of a spreadsheet, from the row of `key` on, or with null each where its topic is. */
  paste(key: number | null, lines: readonly string[][]): void {
    this.remember();
    const from = key === null ? null : this.rows.value.findIndex((row) => row.key === key);
    this.put({ rows: withPasted(this.rows.value, from, lines, () => this.draftRow({ topic: "" })) });
    this.message.value = `Pasted ${lines.length === 1 ? "1 topic" : `${lines.length} topics`}`;
  }

  private putRow(key: number, changes: Partial<DraftRow>): void {
    this.put({ rows: this.rows.value.map((row) => (row.key === key ? { ...row, ...changes } : row)) });
  }

  private put(changes: Partial<Table>): void {
    this.table.value = { ...this.table.value, ...changes };
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.check(), CHECK_AFTER_MS);
  }

  /** Asks the server whether it would save the table: it alone knows what a profile can hold. */
  async check(): Promise<void> {
    window.clearTimeout(this.timer);
    const asked = this.content.value;
    const isReadable = problemsOf(this.rows.value, this.budget.value).length === 0;
    const refusal = isReadable ? await this.refusalOf(this.finishedTable()) : "";
    if (asked === this.content.value) this.refusal.value = refusal;
  }

  private async refusalOf(table: ProfileTable): Promise<string> {
    try {
      const profile = { ...table, name: this.name, base_text: this.typesText };
      return (await this.api.ask("POST /api/profile/check", profile)).problem;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      // A server that is gone refuses nothing: once it is back, the table can be saved.
      return error.status === 0 ? "" : error.message;
    }
  }

  private draftRow(row: Partial<ProfileRow> & { topic: string }): DraftRow {
    return {
      key: this.nextKey++,
      topic: row.topic,
      type: row.type ?? null,
      message_kb: shown(row.message_kb),
      tiers_hz: Array.from({ length: TIER_COUNT }, (_, tier) => shown(row.tiers_hz?.[tier])),
      priority: shown(row.priority),
      source_hz: shown(row.source_hz),
      min_hz: shown(row.min_hz),
      max_hz: shown(row.max_hz),
      accuracies: accuraciesOf(row),
      measured: row.measured ?? null,
    };
  }

  /** The profile as it was read or saved last: it has the types of topics, which nobody types. */
  get typesText(): string {
    return this.table.value.baseText;
  }

  private finishedTable(): ProfileTable {
    const rows = this.rows.value.filter((row) => row.topic.trim() !== "");
    return { rows: rows.map(finished), budget_kb_per_s: toNumber(this.budget.value) };
  }
}

/** The rules that the table of a draft was made for. */
function ownerOf(beside: string): string | null {
  try {
    const { madeFor } = JSON.parse(beside) as { madeFor?: unknown };
    return typeof madeFor === "string" ? madeFor : null;
  } catch {
    return null;
  }
}

/** The table that a draft holds; null where it cannot be read. */
function tableOf(draft: string): Table | null {
  try {
    const { rows, budget, baseText } = JSON.parse(draft) as Table;
    const isTable = rows.every(
      ({ topic, tiers_hz, accuracies, ...cells }) =>
        typeof topic === "string" &&
        areAccuracies(accuracies) &&
        tiers_hz.length === TIER_COUNT &&
        [...tiers_hz, cells.message_kb, cells.priority, cells.source_hz, cells.min_hz, cells.max_hz].every(
          (cell) => typeof cell === "string",
        ),
    );
    if (!isTable || typeof budget !== "string" || typeof baseText !== "string") return null;
    return { rows, budget, baseText };
  } catch {
    return null;
  }
}

function finished(row: DraftRow): ProfileRow {
  return {
    topic: row.topic.trim(),
    type: row.type,
    message_kb: toNumber(row.message_kb),
    source_hz: toNumber(row.source_hz),
    tiers_hz: sixOf(row.tiers_hz.map(toNumber)),
    priority: toNumber(row.priority),
    min_hz: toNumber(row.min_hz),
    max_hz: toNumber(row.max_hz),
    measured: row.measured,
    ...row.accuracies,
  };
}
