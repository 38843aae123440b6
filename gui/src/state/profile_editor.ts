// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";
import { type Api, ApiError } from "../api/client";
import type { FoundFile, ProfileRow, ProfileTable } from "../api/types";
import { type Accuracies, accuraciesOf, areAccuracies, sixOf } from "./accuracies";
import {
  type Conflict,
  type Contested,
  conflictWith,
  type DiskChange,
  diskChangeOf,
  readIfThere,
  saveOver,
} from "./conflict";
import { type DraftRow, problemsOf, TIER_COUNT, toNumber } from "./draft_row";
import type { Draft, Drafts, Restored } from "./drafts";
import { History } from "./history";
import { keepDraft } from "./kept_draft";
import { withPasted } from "./pasted_table";

const CHECK_AFTER_MS = 400;
const shown = (value: number | null | undefined) => (value === null || value === undefined ? "" : String(value));

/** The table of one profile. */
export class ProfileEditor implements Contested {
  readonly rows = signal<readonly DraftRow[]>([]);
  readonly budget = signal("");
  readonly message = signal("");
  readonly conflict = signal<Conflict | null>(null);
  readonly restored = signal<Restored | null>(null);
  readonly diskChange = signal<DiskChange | null>(null);
  readonly isSaved = signal(true);
  /** Whether no file of this name was there yet. */
  readonly isNew = signal(false);
  readonly history = new History();
  /** Why the server would not save the table. */
  private readonly refusal = signal("");
  readonly problems = computed(() => [
    ...problemsOf(this.rows.value, this.budget.value),
    ...(this.refusal.value ? [this.refusal.value] : []),
  ]);
  private timer: number | undefined;
  private baseText = "";
  private readonly hash = signal<string | null>(null);
  private nextKey = 0;
  private isOpen = false;
  private isSaving = false;
  private saving: Promise<void> = Promise.resolve();

  constructor(
    private readonly api: Api,
    readonly name: string,
    private readonly drafts: Drafts,
  ) {}

  /** Reads the profile and what was not saved of it, once; one that is not among the `files` is an empty table. */
  async open(files: readonly FoundFile[]): Promise<void> {
    if (this.isOpen) return;
    const draft = await this.drafts.takeOver("profile", this.name);
    if (files.some((each) => each.name === this.name)) {
      const file = await this.api.read(this.name);
      this.hash.value = file.hash;
      this.load(await this.api.parseProfile(this.name, file.text), file.text);
    } else {
      this.isNew.value = true;
      this.rows.value = [this.draftRow({ topic: "" })];
    }
    this.isOpen = true;
    this.isSaved.value = true;
    if (draft !== null) this.takeUp(draft);
    if (this.drafts.isElsewhere("profile", this.name)) {
      this.message.value = `Another tab has unsaved changes of ${this.name}`;
    }
    keepDraft(this.drafts, "profile", this);
  }

  /** Goes on with what was not saved; where the file is another one by now, a save meets that. */
  private takeUp({ content, hash, changedMs }: Draft): void {
    const table = tableOf(content);
    if (table === null) return;
    this.restored.value = { changedMs, isContested: hash !== this.hash.value };
    this.remember();
    this.baseText = table.baseText;
    this.rows.value = table.rows.map((row) => ({ ...row, key: this.nextKey++ }));
    this.budget.value = table.budget;
    this.hash.value = hash;
    this.changed();
  }

  draft(): (() => Draft) | null {
    const draft = { content: this.snapshot(), hash: this.hash.value, changedMs: Date.now() };
    return this.isSaved.value ? null : () => draft;
  }

  async compare(): Promise<void> {
    const [problem] = this.problems.peek();
    if (problem !== undefined) {
      this.message.value = `What cannot be saved is not compared. ${problem}`;
      return;
    }
    const { text } = await this.api.writeProfile(this.name, this.table(), this.baseText);
    this.conflict.value = conflictWith(text, await readIfThere(this.api, this.name));
  }

  async dropRestored(): Promise<void> {
    if ((await readIfThere(this.api, this.name)) !== null) return this.readAgain();
    this.remember();
    this.baseText = "";
    this.rows.value = [this.draftRow({ topic: "" })];
    this.budget.value = "";
    this.hash.value = null;
    this.conflict.value = this.diskChange.value = null;
    this.isNew.value = this.isSaved.value = true;
    this.message.value = `${this.name} is not on disk`;
  }

  /** Replaces the table by one measured in a bag. */
  async measure(bag: string): Promise<void> {
    await this.take(await this.api.measureProfile(bag));
  }

  /** Replaces the table by one measured on the robot for so many seconds. */
  async measureLive(seconds: number): Promise<void> {
    await this.take(await this.api.ask("POST /api/profile/measure-live", { seconds }));
  }

  async save(): Promise<void> {
    // The one before makes the hash that this one needs.
    const done = this.saving.then(() => this.saveOver(this.hash.value));
    this.saving = done.catch(() => undefined);
    await done;
  }

  async saveAnyway(): Promise<void> {
    const hash = this.conflict.value?.hash;
    if (hash !== undefined) await this.saveOver(hash);
  }

  async readAgain(): Promise<void> {
    const { text, hash } = await this.api.read(this.name);
    await this.take({ text });
    this.hash.value = hash;
    this.conflict.value = this.diskChange.value = null;
    this.isSaved.value = true;
    this.message.value = `Read ${this.name} again`;
  }

  async lookAtDisk(): Promise<void> {
    const hash = this.hash.value;
    if (!this.isOpen || this.isSaving || this.conflict.value !== null) return;
    const change = await diskChangeOf(this.api, this.name, hash);
    // Somebody saved it here meanwhile.
    if (hash !== this.hash.value || this.isSaving) return;
    if (change !== "changed" || !this.isSaved.value) this.diskChange.value = change;
    else {
      await this.readAgain();
      this.message.value = `${this.name} was changed on disk and is read again. Undo brings back what was here`;
    }
  }

  /** Looks at what may be another by now: the server was gone, and checked nothing. */
  async revive(): Promise<void> {
    await this.lookAtDisk();
    await this.check();
  }

  async saveAs(name: string): Promise<void> {
    const { text } = await this.api.writeProfile(name, this.table(), this.baseText);
    await this.api.save(name, text, null);
    this.conflict.value = null;
    this.isSaved.value = true;
  }

  private async saveOver(baseHash: string | null): Promise<void> {
    this.isSaving = true;
    try {
      await this.saveNow(baseHash);
    } finally {
      this.isSaving = false;
    }
  }

  private async saveNow(baseHash: string | null): Promise<void> {
    const asked = this.snapshot();
    const { text } = await this.api.writeProfile(this.name, this.table(), this.baseText);
    const done = await saveOver(this.api, this.name, text, baseHash);
    this.conflict.value = "mine" in done ? done : null;
    if ("mine" in done) return;
    const isWhole = asked === this.snapshot();
    this.hash.value = done.hash;
    this.diskChange.value = null;
    this.isNew.value = false;
    this.baseText = text;
    // What was typed meanwhile is not in the file.
    this.isSaved.value = isWhole;
    this.message.value = `Saved ${this.name}`;
  }

  undo(): void {
    this.restore(this.history.undo(this.snapshot()));
  }

  redo(): void {
    this.restore(this.history.redo(this.snapshot()));
  }

  addRow(): void {
    this.remember();
    this.rows.value = [...this.rows.value, this.draftRow({ topic: "" })];
    this.changed();
  }

  /** Begins a new table with rows for topics: nobody changed anything yet. */
  begin(topics: readonly string[]): void {
    this.rows.value = topics.map((topic) => this.draftRow({ topic }));
    void this.check();
  }

  /** Adds rows for topics, in the place of rows without one. */
  addTopics(topics: readonly string[]): void {
    this.remember();
    const named = this.rows.value.filter((row) => row.topic.trim() !== "");
    this.rows.value = [...named, ...topics.map((topic) => this.draftRow({ topic }))];
    this.changed();
  }

  removeRow(key: number): void {
    this.remember();
    this.rows.value = this.rows.value.filter((row) => row.key !== key);
    this.changed();
  }

  /** A key stroke in a cell. */
  change(key: number, changes: Partial<DraftRow>): void {
    this.remember(performance.now());
    this.replace(key, changes);
  }

  /** Sets the six levels of a row; what goes on, as a drag does, is one step of undo with what went before. */
  setTiers(key: number, tiersHz: readonly number[], goesOn: boolean): void {
    if (!goesOn) this.remember();
    this.replace(key, { tiers_hz: tiersHz.map(shown) });
  }

  /** The same for accuracies of a row, with what they need. */
  setAccuracies(key: number, changes: Partial<Accuracies>, goesOn: boolean): void {
    if (!goesOn) this.remember();
    const before = this.rows.value.find((row) => row.key === key);
    if (before) this.replace(key, { accuracies: { ...before.accuracies, ...changes } });
  }

  setBudget(text: string): void {
    this.remember(performance.now());
    this.budget.value = text;
    this.changed();
  }

  /** Takes cells of a spreadsheet, from the row of `key` on, or with null each where its topic is. */
  paste(key: number | null, lines: readonly string[][]): void {
    this.remember();
    const from = key === null ? null : this.rows.value.findIndex((row) => row.key === key);
    this.rows.value = withPasted(this.rows.value, from, lines, () => this.draftRow({ topic: "" }));
    this.message.value = `Pasted ${lines.length === 1 ? "1 topic" : `${lines.length} topics`}`;
    this.changed();
  }

  private replace(key: number, changes: Partial<DraftRow>): void {
    this.rows.value = this.rows.value.map((row) => (row.key === key ? { ...row, ...changes } : row));
    this.changed();
  }

  private changed(): void {
    this.isSaved.value = false;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.check(), CHECK_AFTER_MS);
  }

  /** Asks the server whether it would save the table: it alone knows what a profile can hold. */
  private async check(): Promise<void> {
    const asked = this.snapshot();
    const isReadable = problemsOf(this.rows.value, this.budget.value).length === 0;
    const refusal = isReadable ? await this.refusalOf(this.table()) : "";
    if (asked === this.snapshot()) this.refusal.value = refusal;
  }

  private async refusalOf(table: ProfileTable): Promise<string> {
    try {
      return (await this.api.ask("POST /api/profile/check", { ...table, name: this.name, base_text: this.baseText }))
        .problem;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      // A server that is gone refuses nothing: once it is back, the table can be saved.
      return error.status === 0 ? "" : error.message;
    }
  }

  private remember(typedMs: number | null = null): void {
    this.history.push(this.snapshot(), typedMs);
  }

  private snapshot(): string {
    return JSON.stringify({ rows: this.rows.value, budget: this.budget.value, baseText: this.baseText });
  }

  private restore(snapshot: string | null): void {
    if (snapshot === null) return;
    const { rows, budget, baseText } = JSON.parse(snapshot) as { rows: DraftRow[]; budget: string; baseText: string };
    this.rows.value = rows;
    this.budget.value = budget;
    this.baseText = baseText;
    this.changed();
  }

  private async take({ text }: { text: string }): Promise<void> {
    const table = await this.api.parseProfile(this.name, text);
    this.remember();
    this.load(table, text);
    this.changed();
  }

  private load(table: ProfileTable, text: string): void {
    this.baseText = text;
    this.rows.value = table.rows.map((row) => this.draftRow(row));
    this.budget.value = shown(table.budget_kb_per_s);
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
    };
  }

  /** The profile as it was read or saved last: it has the types of topics, which nobody types. */
  get typesText(): string {
    return this.baseText;
  }

  private table(): ProfileTable {
    const rows = this.rows.value.filter((row) => row.topic.trim() !== "");
    return { rows: rows.map(finished), budget_kb_per_s: toNumber(this.budget.value) };
  }
}

/** The table that a draft holds; null where it cannot be read. */
function tableOf(content: string): { rows: DraftRow[]; budget: string; baseText: string } | null {
  try {
    const { rows, budget, baseText } = JSON.parse(content) as { rows: DraftRow[]; budget: string; baseText: string };
    const isTable = rows.every(
      ({ topic, tiers_hz, accuracies, ...cells }) =>
        typeof topic === "string" &&
        areAccuracies(accuracies) &&
        tiers_hz.length === TIER_COUNT &&
        [...tiers_hz, cells.message_kb, cells.priority, cells.source_hz, cells.min_hz, cells.max_hz].every(
          (cell) => typeof cell === "string",
        ),
    );
    return isTable && typeof budget === "string" && typeof baseText === "string" ? { rows, budget, baseText } : null;
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
    ...row.accuracies,
  };
}
