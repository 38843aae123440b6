// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, signal } from "@preact/signals";
import { type Api, type Rules, refusalOf } from "../api/client";
import type { Edit, FileAnswer, PlacedFinding, Repair, RuleDocument, Statement } from "../api/types";
import { counted, readable } from "../ui/numbers";
import { CheckQueue } from "./check_queue";
import type { LocalDrafts } from "./drafts";
import { layoutName, type MapSetting, mapOf, PLAIN_GRID, readLayout, writeLayout } from "./layout";
import { diskChangeOf, OpenFile } from "./open_file";
import { Placeholders, worstFirst } from "./placeholders";
import { Folds, sectionsOf, statementsIn, VocabularyCache } from "./statements";
import { Surroundings } from "./surroundings";

/** The whole text is read and checked after each pause in typing: with more blocks, somebody waits for that. */
const MANY_BLOCKS = 1000;
const EMPTY: RuleDocument = { collections: [], findings: [], parses: true };

/**
 * One open rule file: all that the page knows of it. Its text is the truth; statements and findings are what the server
 * reads in it, and panels show them.
 */
export class RuleEditor extends OpenFile {
  readonly text = signal("");
  readonly content = this.text;
  /** What the server read in the text `read`, and when, in ms since 1970. */
  readonly document = signal<RuleDocument>(EMPTY);
  private read: string | null = null;
  readonly checkedMs = signal(0);
  readonly statements = computed(() => statementsIn(this.document.value));
  private readonly byId = computed(() => new Map(this.statements.value.map((each) => [each.id ?? "", each])));
  /** Whether the server has read the rules with their profile: without it, levels would be errors that they are not. */
  readonly isChecked = signal(false);
  private readonly allFindings = computed(() => (this.isChecked.value ? this.document.value.findings : []));
  readonly errors = computed(() => this.allFindings.value.filter((finding) => finding.severity === "error"));
  readonly surroundings = new Surroundings(this.api, this.text, () => this.rules);
  /** What was put there to be changed, until somebody changes it or uses the rules. */
  private readonly placeholders = signal<Placeholders | null>(null);
  /** What the checker says, the worst first: nothing of what placeholders bring. */
  readonly findings = computed(() => {
    const placeholders = this.placeholders.value;
    const all = [...this.allFindings.value, ...this.surroundings.findings.value];
    return worstFirst(all.filter((each) => !placeholders?.bring(each, this.byId.value)));
  });
  /** What to know of a text that is too long to be edited here with ease; empty where it is not. */
  readonly tooLong = computed(() => {
    const { length } = this.statements.value;
    if (length <= MANY_BLOCKS) return "";
    return `${counted(length, "block")} in one file: beyond ${readable(MANY_BLOCKS)}, findings come late and the page is slow. Split the file; a robot reads all rule files of a folder.`;
  });
  private readonly checks = new CheckQueue(
    () => this.rules,
    (rules) => this.ask(rules),
  );

  /** The last document that could be read whole: what the blocks show, with the text it was read from. */
  readonly shown = signal<{ document: RuleDocument; text: string } | null>(null);
  readonly shownStatements = computed(() => statementsIn(this.shown.value?.document ?? EMPTY));
  /** The titles of what the blocks show, by the number of the statement under each. */
  readonly shownSections = computed(() => sectionsOf(this.shown.value?.text ?? "", this.shownStatements.value));
  /** Whether no statement is there yet. */
  readonly isEmpty = computed(() => this.shownStatements.value.length === 0);
  /** Whether the blocks show the past, because the text of now cannot be read. */
  readonly isBroken = computed(() => !this.document.value.parses && this.shown.value?.document !== this.document.value);
  /** The blocks, shown or left, that have something on its way into the text. */
  private readonly ahead = signal<ReadonlySet<object>>(new Set());
  /** How many blocks say nothing that the text could say, such as a check outside a rule. */
  blocksLeftOut = 0;
  /** Brings into the text what blocks say, an open field too where that is asked for; whether nothing is left out. */
  handOver: ((withOpenField: boolean) => Promise<boolean>) | null = null;

  readonly spot = signal<Spot | null>(null);
  /** What to suggest. */
  readonly words = new VocabularyCache(this.api);
  readonly profileChoice = new RuleProfile(this.api);
  readonly profile = this.profileChoice.used;

  /** What zones are drawn on, which a side file keeps. */
  readonly map = signal<MapSetting>(PLAIN_GRID);
  private readonly savedMap = signal<MapSetting>(PLAIN_GRID);
  private layoutHash: string | null = null;
  /** Takes back a part of a zone that is not in the text yet; whether there was any. */
  takeBack: (() => boolean) | null = null;

  readonly beside = computed(() => JSON.stringify({ map: this.map.value }));
  override readonly isInFile = computed(() => this.isContentSaved.value && this.map.value === this.savedMap.value);
  override readonly isSaved = computed(() => this.isInFile.value && this.ahead.value.size === 0);

  constructor(
    api: Api,
    name: string,
    drafts: LocalDrafts,
    /** Which rules are folded. */
    readonly folds = new Folds(),
    /** Says what was left in the blocks of this file and did not come into its text. */
    readonly lost = signal<LostChanges | null>(null),
  ) {
    super(api, name, drafts);
  }

  /** The file as every call of the server names it. */
  get rules(): Rules {
    const profile = this.profile.value;
    const named = profile === null ? {} : { profile_name: profile.name };
    return { text: this.text.value, name: this.name, profile_text: profile?.text ?? null, ...named };
  }

  /** Reads the file, its side file if there is one, and what was not saved of them. */
  override async open(): Promise<void> {
    await super.open();
    await this.recallProfile();
  }

  protected setContent(text: string): void {
    this.text.value = text;
  }

  protected contentOfDraft(text: string): string {
    return text;
  }

  protected setBeside(beside: string | null): void {
    const saved = this.savedMap.value;
    const map = beside === null ? saved : mapOf(beside);
    this.map.value = JSON.stringify(map) === JSON.stringify(saved) ? saved : map;
  }

  protected linesOf(text: string): string {
    return text;
  }

  protected override get isSettled(): boolean {
    return this.ahead.value.size === 0;
  }

  async useProfile(name: string | null): Promise<void> {
    await this.profileChoice.use(name);
    await this.check();
  }

  /** Checks the rules with the profile that goes with them. */
  async recallProfile(): Promise<void> {
    await this.attempt(() => this.profileChoice.recall(this.rules));
    await this.check();
  }

  /** A key stroke in the text. */
  type(text: string): void {
    if (text === this.text.value) return;
    this.remember(performance.now());
    this.text.value = text;
    this.checks.soon();
  }

  override undo(): void {
    if (!this.takeBack?.()) super.undo();
  }

  /** Does edits of the text that was read as one step of undo; `refused` hears why they change nothing. */
  edit(
    edits: (document: RuleDocument) => Edit[],
    refused: (why: string) => void = (why) => (this.message.value = why),
    /** Whether what comes is to be changed, as a new rule is. */
    isPlaceholder = () => false,
  ): Promise<void> {
    return this.inTurn(async () => {
      // Edits name statements by what the server read last, which must be this text; where it cannot, that was told.
      if (!(await this.isRead())) return refused(this.message.value);
      const before = this.text.value;
      const wanted = edits(this.document.value);
      if (wanted.length === 0) return;
      const why = await refusalOf(async () => {
        const { text, document } = await this.api.ask("POST /api/edit", { ...this.rules, edits: wanted });
        if (text === before) return;
        if (this.text.value === before) {
          const [known, found, earlier] = [this.statements.value, this.findings.value, this.placeholders.value];
          batch(() => {
            this.replaceText(text, document);
            if (isPlaceholder())
              this.placeholders.value = new Placeholders(known, found, statementsIn(document), earlier);
          });
        } else refused("The text was changed at the same time, so the edit in the blocks was dropped: try again");
      });
      if (why !== "") refused(why);
    });
  }

  /** Shows what placeholders bring, too, as before the rules are used. */
  showAllFindings(): void {
    this.placeholders.value = null;
  }

  /** One-click fix of a finding, which the text must still have once it was read again; one that brings errors is not kept. */
  async fix(finding: PlacedFinding): Promise<void> {
    const said = JSON.stringify(finding);
    const errors = this.errors.peek().length;
    await this.edit(({ findings }) => {
      const same = [...findings, ...this.surroundings.findings.peek()].find((each) => JSON.stringify(each) === said);
      if (!same?.fix) this.message.value = "The text was changed at the same time, so nothing was mended: try again";
      return same?.fix ? [same.fix.edit] : [];
    });
    if (this.errors.peek().length <= errors) return;
    this.undo();
    this.message.value = `“${finding.fix?.title}” would bring an error, so it was taken back`;
  }

  /** One-click repair of what does not fit the budget, in the text that the optimizer was asked about. */
  repair(text: string, { edits }: Pick<Repair, "edits">): Promise<void> {
    return this.edit(() => (text === this.text.value ? edits : []));
  }

  /** Puts the text into the house style as one step of undo, unless it has errors or somebody goes on writing. */
  async format(): Promise<void> {
    await this.handOver?.(false);
    await this.queued(async () => {
      const { rules } = this;
      const { text } = await this.api.ask("POST /api/format", rules);
      if (rules.text === this.text.value) await this.setText(text);
    }).catch(() => undefined);
  }

  /** The rules once all that was asked for is done: the text that somebody just left is in the house style then. */
  async settledRules(): Promise<Rules> {
    await this.handOver?.(false);
    await this.inTurn(async () => {});
    return this.rules;
  }

  async setText(text: string): Promise<void> {
    if (text !== this.text.value) await this.replace(text);
  }

  override async save(): Promise<void> {
    const isWhole = (await this.handOver?.(true)) ?? true;
    await this.attempt(() => super.save());
    if (isWhole || !this.isInFile.value) return;
    this.message.value = `Saved ${this.name} without what is being typed`;
  }

  protected override async readBeside(): Promise<void> {
    const { map, hash } = await readLayout(this.api, this.name);
    this.map.value = this.savedMap.value = map;
    this.layoutHash = hash;
  }

  protected override async saveBeside(): Promise<void> {
    const map = this.map.value;
    if (map !== this.savedMap.value)
      this.layoutHash = await writeLayout(this.api, layoutName(this.name), map, this.layoutHash);
    this.savedMap.value = map;
  }

  protected override lackWords(): string {
    const count = this.blocksLeftOut;
    if (count === 0) return "";
    return ` without ${counted(count, "block")} that ${count === 1 ? "is" : "are"} not in the text`;
  }

  override async lookAtDisk(): Promise<void> {
    await super.lookAtDisk();
    if (await this.profileChoice.lookAtDisk(this.rules)) await this.check();
  }

  /** Asks the server for everything again, as after it was gone. */
  async revive(): Promise<void> {
    await this.attempt(() => this.lookAtDisk());
    this.read = null;
    await this.inTurn(() => this.profileChoice.revive());
    await this.check();
  }

  /** The statement with this id in what the blocks show. */
  statement(id: string | null): Statement | undefined {
    return id === null ? undefined : this.byId.value.get(id);
  }

  /** The statement that a place of the text belongs to. */
  statementAt(offset: number): Statement | undefined {
    return this.statements.value.find((each) => (each.offset ?? 0) <= offset && offset <= (each.end_offset ?? 0));
  }

  /** Points at a statement, on whichever side somebody looks; at nothing where it has no place. */
  point(statement: Statement | undefined, from: Spot["from"]): void {
    const { offset, end_offset } = statement ?? {};
    const isPlaced = offset !== undefined && end_offset !== undefined;
    this.spot.value = isPlaced ? { offset, end_offset, from } : null;
  }

  /** Points at the statement that holds a line; at nothing for null. */
  showLine(line: number | null): void {
    this.point(line === null ? undefined : this.statements.peek().findLast((each) => (each.line ?? 0) <= line), "try");
  }

  /** Notes whether `blocks` have something that is on its way into the text. */
  setAhead(blocks: object, isAhead: boolean): void {
    const ahead = this.ahead.peek();
    if (ahead.has(blocks) === isAhead) return;
    this.ahead.value = new Set(isAhead ? [...ahead, blocks] : [...ahead].filter((each) => each !== blocks));
  }

  private replaceText(text: string, document: RuleDocument): void {
    this.remember();
    batch(() => {
      this.text.value = text;
      this.accept(document, text);
    });
  }

  check(): Promise<void> {
    return this.checks.check();
  }

  private async ask(rules: Rules): Promise<void> {
    const isProfileKnown = this.profileChoice.isKnown.peek();
    await this.attempt(async () => {
      const read = this.api.ask("POST /api/document", rules);
      const [document, vocabulary] = await Promise.all([read, this.words.of(rules, read)]);
      if (rules.text !== this.text.value) return;
      batch(() => {
        this.words.vocabulary.value = vocabulary;
        this.accept(document, rules.text);
        if (isProfileKnown) this.isChecked.value = true;
      });
    });
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

  /** Does work once all that was asked for before is done; a refusal is said. */
  async inTurn(work: () => Promise<void>): Promise<void> {
    await this.attempt(() => this.queued(work));
  }
}

/** A stretch of the text that one side points at and the other shows. */
interface Spot {
  offset: number;
  end_offset: number;
  from: "text" | "blocks" | "findings" | "map" | "try";
}

/** What blocks said when they were left and the text does not say, in a few words each. */
export interface LostChanges {
  readonly name: string;
  readonly changes: readonly string[];
  readonly why: string;
}

/** The topic parameters that a rule file is checked and optimized with. */
export class RuleProfile {
  readonly used = signal<FileAnswer | null>(null);
  /** Whether it was asked which profile goes with the rules, and no other is being read. */
  readonly isKnown = signal(false);
  /** The profile that was chosen for the rules, where it is no longer there. */
  readonly gone = signal<string | null>(null);
  private wanted: { readonly name: string | null } = { name: null };

  constructor(private readonly api: Api) {}

  /** Uses the profile that was chosen for the rules, else the likeliest; what is chosen meanwhile stays. */
  async recall(rules: Rules): Promise<void> {
    const { wanted } = this;
    this.isKnown.value = false;
    try {
      const { name, gone } = await this.api.profileFor(rules);
      if (this.wanted !== wanted) return;
      await this.use(name, gone);
    } finally {
      if (this.wanted === wanted) this.isKnown.value = true;
    }
  }

  async use(name: string | null, gone: string | null = null): Promise<void> {
    const wanted = { name };
    this.wanted = wanted;
    this.gone.value = gone;
    this.isKnown.value = false;
    try {
      const profile = name === null ? null : await this.api.read(name);
      if (this.wanted === wanted) this.used.value = profile;
    } finally {
      if (this.wanted === wanted) this.isKnown.value = true;
    }
  }

  /** Takes the profile as it is on disk by now, or the one in its place; whether that is another. */
  async lookAtDisk(rules: Rules): Promise<boolean> {
    const used = this.used.value;
    if (used === null) return false;
    const change = await diskChangeOf(this.api, used.name, used.hash);
    if (change === null || used !== this.used.value) return false;
    await (change === "gone" ? this.recall(rules) : this.revive());
    return true;
  }

  /** Reads the profile again. */
  revive(): Promise<void> {
    return this.use(this.wanted.name, this.gone.value);
  }
}
