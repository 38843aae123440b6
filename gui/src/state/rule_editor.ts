// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, signal } from "@preact/signals";
import { type Api, type Rules, refusal, refusalOf } from "../api/client";
import type { Edit, PlacedFinding, Repair, RuleDocument, Statement } from "../api/types";
import { sectionsOf } from "../blocks/sections";
import { CheckQueue } from "./check_queue";
import {
  type Conflict,
  type Contested,
  conflictWith,
  type DiskChange,
  diskChangeOf,
  NOT_THERE,
  type OnDisk,
  readIfThere,
  saveOver,
} from "./conflict";
import type { Draft, Drafts, Restored } from "./drafts";
import { Folds } from "./folds";
import { History } from "./history";
import { keepDraft } from "./kept_draft";
import { layoutName, type MapSetting, PLAIN_GRID, readLayout, sideFileOf, writeLayout } from "./layout";
import { RuleProfile } from "./rule_profile";
import type { Spot } from "./spot";
import { statementsIn } from "./statements";
import { Words } from "./words";
import { type Lost, WorkAhead, withoutBlocks } from "./work_ahead";

const EMPTY: RuleDocument = { collections: [], findings: [], parses: true };

/** One open rule file. Its text is the truth; blocks and findings are what the server reads in it. */
export class RuleEditor implements Contested {
  readonly text = signal("");
  readonly document = signal<RuleDocument>(EMPTY);
  /** The last document that could be read whole: what the blocks show, with the text it was read from. */
  readonly shown = signal<{ document: RuleDocument; text: string } | null>(null);
  readonly profileChoice: RuleProfile;
  readonly profile: RuleProfile["used"];
  readonly spot = signal<Spot | null>(null);
  readonly message = signal<string>("");
  readonly conflict = signal<Conflict | null>(null);
  readonly restored = signal<Restored | null>(null);
  readonly diskChange = signal<DiskChange | null>(null);
  /** When the server read the text last, in ms since 1970. */
  readonly checkedMs = signal(0);
  /** What zones are drawn on. */
  readonly map = signal<MapSetting>(PLAIN_GRID);
  readonly history = new History();
  private readonly saved = signal<{ text: string; hash: string | null; map: MapSetting }>({
    text: "",
    hash: null,
    map: PLAIN_GRID,
  });
  readonly ahead = new WorkAhead();
  readonly shownStatements = computed(() => statementsIn(this.shown.value?.document ?? EMPTY));
  /** The titles of what the blocks show, by the number of the statement under each. */
  readonly shownSections = computed(() => sectionsOf(this.shown.value?.text ?? "", this.shownStatements.value));
  /** Whether no statement is there yet. */
  readonly isEmpty = computed(() => this.shownStatements.value.length === 0);
  /** Whether the file holds the text, and its side file the map. */
  readonly isInFile = computed(
    () => this.text.value === this.saved.value.text && this.map.value === this.saved.value.map,
  );
  /** Whether the file holds all that the page shows. */
  readonly isSaved = computed(() => this.isInFile.value && !this.ahead.isAny.value);
  /** What the file says. */
  readonly savedText = computed(() => this.saved.value.text);
  readonly isTextSaved = computed(() => this.text.value === this.savedText.value);
  /** How many blocks say nothing that the text could say, such as a check outside a rule. */
  blocksLeftOut = 0;
  /** Takes back a part of something that is not in the text yet; whether there was any. */
  takeBack: (() => boolean) | null = null;
  /** Brings into the text what blocks say, an open field too where that is asked for; whether nothing is left out. */
  handOver: ((withOpenField: boolean) => Promise<boolean>) | null = null;
  /** Whether the server has read the rules with their profile: without it, levels would be errors that they are not. */
  readonly isChecked = signal(false);
  readonly findings = computed(() => (this.isChecked.value ? this.document.value.findings : []));
  readonly statements = computed(() => statementsIn(this.document.value));
  private readonly byId = computed(() => new Map(this.statements.value.map((each) => [each.id ?? "", each])));
  readonly errors = computed(() => this.findings.value.filter((finding) => finding.severity === "error"));
  /** Whether the blocks show the past, because the text of now cannot be read. */
  readonly isBroken = computed(() => !this.document.value.parses && this.shown.value?.document !== this.document.value);
  /** Whether its file was read. */
  isOpen = false;
  private layoutHash: string | null = null;
  /** The text that `document` was read from. */
  private read: string | null = null;
  private queue: Promise<void> = Promise.resolve();
  private readonly checks = new CheckQueue(
    () => this.rules,
    (rules) => this.ask(rules),
  );
  /** What to suggest. */
  readonly words: Words;

  constructor(
    private readonly api: Api,
    readonly name: string,
    private readonly drafts: Drafts,
    /** Which rules are folded. */
    readonly folds = new Folds(),
    /** Says what was left in the blocks of this file and did not come into its text. */
    readonly lost = signal<Lost | null>(null),
  ) {
    this.words = new Words(api);
    this.profileChoice = new RuleProfile(api);
    this.profile = this.profileChoice.used;
  }

  /** The file as every call of the server names it. */
  get rules(): Rules {
    const profile = this.profile.value;
    const named = profile === null ? {} : { profile_name: profile.name };
    return { text: this.text.value, name: this.name, profile_text: profile?.text ?? null, ...named };
  }

  /** Reads the file, its side file if there is one, and what was not saved of them. */
  async open(): Promise<void> {
    const draft = await this.drafts.takeOver("rules", this.name);
    // What was not saved of a file that is gone can still be saved.
    const onDisk = draft ? readIfThere(this.api, this.name) : this.api.read(this.name);
    const [found, side] = await Promise.all([onDisk, readLayout(this.api, this.name)]);
    const file = found ?? NOT_THERE;
    this.layoutHash = side.hash;
    batch(() => {
      this.map.value = side.map;
      this.saved.value = { text: file.text, hash: file.hash, map: side.map };
      this.text.value = file.text;
      this.history.clear();
      if (draft !== null) this.restore(draft);
    });
    if (this.drafts.isElsewhere("rules", this.name))
      this.message.value = `Another tab has unsaved changes of ${this.name}`;
    this.isOpen = true;
    keepDraft(this.drafts, "rules", this);
    await this.recallProfile();
  }

  /** Goes on with what was not saved; where the file is another one by now, a save meets that. */
  private restore({ content, hash, changedMs }: Draft): void {
    const mine = sideFileOf(content);
    if (mine.text === undefined) return;
    const { saved } = this;
    this.history.push(saved.value.text);
    this.text.value = mine.text;
    if (JSON.stringify(mine.map) !== JSON.stringify(saved.value.map)) this.map.value = mine.map;
    this.restored.value = { changedMs, isContested: hash !== saved.value.hash };
    saved.value = { ...saved.value, hash };
  }

  draft(): (() => Draft) | null {
    const [text, map, { hash }] = [this.text.value, this.map.value, this.saved.value];
    const changedMs = Date.now();
    return this.isInFile.value ? null : () => ({ content: JSON.stringify({ text, map }), hash, changedMs });
  }

  async compare(): Promise<void> {
    this.conflict.value = conflictWith(this.text.value, await readIfThere(this.api, this.name));
  }

  async dropRestored(): Promise<void> {
    const onDisk = await readIfThere(this.api, this.name);
    await this.take(onDisk ?? NOT_THERE, onDisk ? `Read ${this.name} again` : `${this.name} is not on disk`);
    this.map.value = this.saved.value.map;
  }

  async useProfile(name: string | null): Promise<void> {
    await this.profileChoice.use(name);
    await this.check();
  }

  /** Checks the rules with the profile that goes with them. */
  async recallProfile(): Promise<void> {
    await this.profileChoice.recall(this.rules).catch((error: unknown) => this.tell(error));
    await this.check();
  }

  /** A key stroke in the text. */
  type(text: string): void {
    if (text === this.text.value) return;
    this.history.push(this.text.value, performance.now());
    this.text.value = text;
    this.checks.soon();
  }

  undo(): void {
    if (!this.takeBack?.()) this.goTo(this.history.undo(this.text.value));
  }

  redo(): void {
    this.goTo(this.history.redo(this.text.value));
  }

  /** Does edits of the text that was read as one step of undo; `refused` hears why they change nothing. */
  edit(
    edits: (document: RuleDocument) => Edit[],
    refused: (why: string) => void = (why) => (this.message.value = why),
  ): Promise<void> {
    return this.inTurn(async () => {
      // Edits name statements by what the server read last, which must be this text; where it cannot, that was told.
      if (!(await this.isRead())) return refused(this.message.value);
      const before = this.text.value;
      const wanted = edits(this.document.value);
      if (wanted.length === 0) return;
      const why = await refusalOf(async () => {
        const { text, document } = await this.api.edit(this.rules, wanted);
        if (text === before) return;
        if (this.text.value === before) this.replaceText(text, document);
        else refused("The text was changed at the same time, so the edit in the blocks was dropped: try again");
      });
      if (why !== "") refused(why);
    });
  }

  /** One-click fix of a finding of the text that was read last. */
  fix(finding: PlacedFinding): Promise<void> {
    return this.edit(({ findings }) => (finding.fix && findings.includes(finding) ? [finding.fix.edit] : []));
  }

  /** One-click repair of what does not fit the budget, in the text that the optimizer was asked about. */
  repair(text: string, { edits }: Pick<Repair, "edits">): Promise<void> {
    return this.edit(() => (text === this.text.value ? edits : []));
  }

  async format(): Promise<void> {
    await this.inTurn(async () => {
      const { rules } = this;
      const { text } = await this.api.ask("POST /api/format", rules);
      if (rules.text === this.text.value) await this.setText(text);
      else this.message.value = "The text was changed at the same time, so it was not formatted: try again";
    });
  }

  async setText(text: string): Promise<void> {
    if (text === this.text.value) return;
    this.history.push(this.text.value);
    this.text.value = text;
    await this.check();
  }

  async save(byItself = false): Promise<void> {
    const isWhole = (await this.handOver?.(!byItself)) ?? true;
    await this.inTurn(() => this.saveOver(this.saved.value.hash, byItself));
    if (isWhole || byItself || !this.isInFile.value) return;
    this.message.value = `Saved ${this.name} without what is being typed`;
  }

  async saveAnyway(): Promise<void> {
    const hash = this.conflict.value?.hash;
    if (hash !== undefined) await this.saveOver(hash);
  }

  async readAgain(): Promise<void> {
    await this.take(await this.api.read(this.name), `Read ${this.name} again`);
  }

  private async take({ text, hash }: OnDisk | typeof NOT_THERE, message: string): Promise<void> {
    this.history.push(this.text.value);
    batch(() => {
      this.conflict.value = this.diskChange.value = null;
      this.saved.value = { ...this.saved.value, text, hash };
      this.text.value = text;
    });
    this.message.value = message;
    await this.check();
  }

  async lookAtDisk(): Promise<void> {
    await this.inTurn(async () => {
      if (this.conflict.value !== null) return;
      const change = await diskChangeOf(this.api, this.name, this.saved.value.hash);
      if (change === "changed" && this.isSaved.value) {
        const message = `${this.name} was changed on disk and is read again. Undo brings back what was here`;
        await this.take(await this.api.read(this.name), message);
      } else this.diskChange.value = change;
    });
    if (await this.profileChoice.lookAtDisk(this.rules)) await this.check();
  }

  /** Asks the server for everything again, as after it was gone. */
  async revive(): Promise<void> {
    await this.lookAtDisk();
    this.read = null;
    await this.inTurn(() => this.profileChoice.revive());
    await this.check();
  }

  async saveAs(name: string): Promise<void> {
    const [text, map] = [this.text.value, this.map.value];
    await this.api.save(name, text, null);
    if (map !== PLAIN_GRID) await writeLayout(this.api, layoutName(name), map, null);
    this.conflict.value = null;
    // All that is here is in the new file.
    this.saved.value = { text, hash: null, map };
  }

  private async saveOver(baseHash: string | null, byItself = false): Promise<void> {
    const [text, map] = [this.text.value, this.map.value];
    const done = await saveOver(this.api, this.name, text, baseHash, byItself);
    this.conflict.value = "mine" in done ? done : null;
    if ("mine" in done) return;
    this.diskChange.value = null;
    this.saved.value = { ...this.saved.value, text, hash: done.hash };
    if (map !== this.saved.value.map) {
      this.layoutHash = await writeLayout(this.api, layoutName(this.name), map, this.layoutHash);
    }
    this.saved.value = { ...this.saved.value, map };
    if (done.note) this.message.value = `Saved ${this.name}, but no version is kept of it: ${done.note}`;
    else if (!byItself) this.message.value = `Saved ${this.name}${withoutBlocks(this.blocksLeftOut)}`;
  }

  /** The statement with this id in what the blocks show. */
  statement(id: string | null): Statement | undefined {
    return id === null ? undefined : this.byId.value.get(id);
  }

  /** The statement that a place of the text belongs to. */
  statementAt(offset: number): Statement | undefined {
    return this.statements.value.find((each) => (each.offset ?? 0) <= offset && offset <= (each.end_offset ?? 0));
  }

  private goTo(text: string | null): void {
    if (text === null) return;
    this.text.value = text;
    void this.check();
  }

  private replaceText(text: string, document: RuleDocument): void {
    this.history.push(this.text.value);
    batch(() => {
      this.text.value = text;
      this.accept(document, text);
    });
  }

  /** Asks the server what the text says now. */
  check(): Promise<void> {
    return this.checks.check();
  }

  private async ask(rules: Rules): Promise<void> {
    const isProfileKnown = this.profileChoice.isKnown.peek();
    try {
      const askedMs = performance.now();
      const read = this.api.document(rules).then((document) => {
        this.checks.answerMs = performance.now() - askedMs;
        return document;
      });
      const [document, vocabulary] = await Promise.all([read, this.words.of(rules, read)]);
      if (rules.text !== this.text.value) return;
      batch(() => {
        this.words.vocabulary.value = vocabulary;
        this.accept(document, rules.text);
        if (isProfileKnown) this.isChecked.value = true;
      });
    } catch (error) {
      this.tell(error);
    }
  }

  /** Whether the text has no errors, once it was read and says all that the blocks say. */
  async isSound(): Promise<boolean> {
    await this.handOver?.(false);
    await this.queue;
    return (await this.isRead()) && this.errors.value.length === 0;
  }

  /** Whether the server has read the text of now; where it has not, it is asked to. */
  private async isRead(): Promise<boolean> {
    for (let asked: string | null = null; this.read !== this.text.value && asked !== this.text.value; ) {
      asked = this.text.value;
      await this.check();
    }
    return this.read === this.text.value;
  }

  private accept(document: RuleDocument, text: string): void {
    this.document.value = document;
    this.read = text;
    this.checkedMs.value = Date.now();
    if (document.parses || this.shown.value === null) this.shown.value = { document, text };
  }

  /** Does this once all that was asked for before is done. */
  async inTurn(work: () => Promise<void>): Promise<void> {
    const done = this.queue.then(work).catch((error: unknown) => this.tell(error));
    // Whoever asked hears of a bug; what comes after it has its turn all the same.
    this.queue = done.catch(() => undefined);
    await done;
  }

  /** Says a refusal; anything else is a bug and goes on. */
  tell(error: unknown): void {
    this.message.value = refusal(error);
  }
}
