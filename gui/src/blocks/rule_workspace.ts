// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Edit, PlacedFinding, RuleDocument, Statement } from "../api/types";
import type { Folds } from "../state/folds";
import { Badges } from "./badges";
import { type RuleAct, showRawText } from "./block_types";
import { Column, GAP, HEADING } from "./column";
import type { Suggestions } from "./fields";
import { FOLDED } from "./folded_type";
import { showJoins } from "./joins";
import type { RuleState } from "./live_states";
import type { MenuPage } from "./menus";
import { fingerprint, toBlock, toStatement } from "./model";
import { newWorkspace } from "./new_workspace";
import { closeField, isTyping, openField } from "./open_field";
import { blocklyTheme } from "./palette";
import { covers, follow, inPart, type Part, partAround, partAt } from "./part";
import { Rows } from "./rows";
import { type ActedOn, actedOn } from "./rule_acts";
import {
  asOfNow,
  editsOf,
  isTop,
  newSlot,
  type Placed,
  printOf,
  type Slot,
  type Standing,
  saidBy,
  statementOf,
  statementsOf,
} from "./slots";
import { NEW_RATE, NEW_RULE } from "./toolbox";
import { Warnings } from "./warnings";

type Print = (slot: Slot) => string | null;
type EditsOf = (document: RuleDocument) => Edit[];

/** What the workspace tells and asks. */
export interface WorkspaceOwner {
  suggestions: Suggestions;
  /** What the menus on blocks do with the page. */
  menus: Omit<MenuPage, "newRate" | "newRule" | "foldAll">;
  /** Rules to take from the list of blocks. */
  recipes: readonly Statement[];
  /** Blocks say something else than the text: `editsOf` it bring it there. */
  changed(editsOf: EditsOf): Promise<void>;
  /** Whether blocks say something that is not in the text yet. */
  ahead(isAhead: boolean): void;
  /** Asks for `show` with what the text says now. */
  showAgain(): void;
  selected(statement: string | null): void;
  /** How many blocks say nothing that the text could say. */
  leftOut(count: number): void;
  folds: Folds;
}

/** The blocks of one rule file, kept in step with its text. */
export class RuleWorkspace {
  private readonly workspace: Blockly.WorkspaceSvg;
  private readonly column: Column;
  private slots: Slot[] = [];
  private waiting = false;
  /** Changes of blocks that are on their way into the text. */
  private underWay = 0;
  private findings: readonly PlacedFinding[] = [];
  /** All statements of the document that is shown, and which of them are blocks. */
  private placed: readonly Placed[] = [];
  private sections: ReadonlyMap<number, string> = new Map();
  private part: Part = { first: 0, count: 0, total: 0 };
  private readonly rows: Rows;
  private isLooking = false;
  private document: RuleDocument | null = null;
  private readonly warnings = new Warnings();
  private revealed: Blockly.BlockSvg | null = null;
  private readonly badges = new Badges();
  private states: ReadonlyMap<string, RuleState> = new Map();
  /** What blocks said when somebody left them: nothing reads or changes a block after that. */
  private left: Standing | null = null;

  constructor(
    private readonly host: HTMLElement,
    private readonly owner: WorkspaceOwner,
  ) {
    const acts = {
      act: (block: Blockly.BlockSvg, what: RuleAct) => void this.act(block, what),
      toggleFold: (block: Blockly.BlockSvg) => void this.toggleFold(block),
    };
    this.rows = new Rows((statement) => owner.folds.isFolded(statement));
    this.workspace = newWorkspace(host, owner.suggestions, owner.recipes, acts, {
      ...owner.menus,
      foldAll: (isFolded) => void this.foldAll(isFolded),
      newRate: () => this.add(toBlock(NEW_RATE)),
      newRule: () => this.add(toBlock(NEW_RULE)),
    });
    this.column = new Column(this.workspace);
    this.workspace.addChangeListener((event) => this.listen(event));
  }

  /**
   * Shows a document, touching only the blocks of statements that changed.
   *
   * Does nothing while blocks are ahead of the text; it asks for another call then.
   */
  show(document: RuleDocument, sections: ReadonlyMap<number, string>): void {
    if (this.isAhead() || this.left) return;
    this.sections = sections;
    this.take(document, printOf);
  }

  /** Shows a document that changed before what blocks say came into it; blocks that are ahead of it stay. */
  catchUp(document: RuleDocument): void {
    if (document !== this.document && !this.left) this.take(document, (slot) => slot.print);
  }

  private take(document: RuleDocument, print: Print): void {
    const all = statementsOf(document);
    const { folds } = this.owner;
    const isFirst = this.placed.length === 0;
    folds.follow(
      this.statements(),
      all.map(({ statement }) => statement),
    );
    this.document = document;
    const keys = (placed: readonly Placed[]) => placed.map(({ statement }) => statement.key ?? "");
    this.part = follow(this.part, keys(this.placed), keys(all));
    this.placed = all;
    if (isFirst) this.column.restart(GAP + (this.sections.has(0) ? HEADING : 0));
    this.showPart(print);
    this.lookSoon();
  }

  private statements(): Statement[] {
    return this.placed.map(({ statement }) => statement);
  }

  /** Draws the part of the text around the statement with this number. */
  private goTo(index: number): void {
    if (this.isAhead()) return;
    this.move(partAround(index, this.placed.length));
  }

  /** Draws another part of the text; what both have stays where it is. */
  private move(part: Part): void {
    const offsets = this.offsets();
    const { top } = this.column;
    const { first, count } = this.part;
    const isApart = part.first >= first + count || first >= part.first + part.count;
    if (isApart) this.column.restart(top + (offsets[part.first] ?? 0));
    const focused = this.focusedAt();
    if (focused >= 0 && (focused < part.first || focused >= part.first + part.count)) this.letGoOfFocus();
    this.part = part;
    this.showPart(printOf, true);
  }

  /** The number of the statement whose block has the focus. */
  private focusedAt(): number {
    const node = Blockly.getFocusManager().getFocusedNode();
    const block = node instanceof Blockly.Field ? node.getSourceBlock() : node;
    const statement = block instanceof Blockly.BlockSvg ? statementOf(block) : null;
    const at = this.slots.findIndex((slot) => slot.block === statement);
    return at < 0 ? -1 : this.part.first + at;
  }

  /** Blockly gives the focus of a block that goes to a neighbour, a little later, and scrolls there. */
  private letGoOfFocus(): void {
    Blockly.getFocusManager().focusNode(this.workspace);
  }

  private offsets(): number[] {
    return this.rows.offsets(this.statements(), this.sections);
  }

  /** Draws what came near the view, once nobody has anything in hand. */
  private lookSoon(): void {
    if (this.isLooking) return;
    this.isLooking = true;
    requestAnimationFrame(() => {
      this.isLooking = false;
      if (this.left) return;
      if (this.isAhead() || this.isInHand()) this.lookSoon();
      else this.look();
    });
  }

  private look(): void {
    const view = this.workspace.getMetricsManager().getViewMetrics(true);
    const offsets = this.offsets();
    const top = view.top - this.column.top;
    const bottom = top + view.height;
    if (covers(this.part, partAt(offsets, top, bottom))) return;
    this.move(partAt(offsets, top - view.height / 2, bottom + view.height / 2));
  }

  /** Whether blocks say something that is not in the text yet. Blockly tells of a change a picture or two later. */
  private isAhead(): boolean {
    if (this.waiting || this.underWay > 0) return true;
    return !this.left && this.slots.some((slot) => (printOf(slot) ?? slot.print) !== slot.print);
  }

  private showPart(print: Print = printOf, isMoved = false): void {
    const statements = inPart(this.statements(), this.part);
    // Between two parts there is less to scroll over, which must not move the view. The column allows it again.
    this.workspace.setResizesEnabled(false);
    this.quietly(() => {
      const reused = this.reuse(statements, print);
      const old = new Set(this.slots.map((slot) => slot.block));
      for (const block of reused) if (block) old.delete(block);
      for (const block of old) if (!block.isDisposed()) block.dispose(true);
      this.slots = statements.map((statement, index) => newSlot(reused[index] ?? this.create(statement), statement));
      showJoins(this.workspace, this.owner.suggestions);
    });
    this.arrange(isMoved);
    this.rows.measure(statements, this.slots);
    this.mark(this.findings);
    this.showLive(this.states);
  }

  private arrange(isMoved: boolean): void {
    const { first, count } = this.part;
    const offsets = this.offsets();
    const at = (index: number) => offsets[index] ?? 0;
    const headings = new Map<Blockly.BlockSvg, string>();
    this.slots.forEach(({ block }, index) => {
      const words = this.sections.get(first + index);
      if (words !== undefined) headings.set(block, words);
    });
    const shape = { above: at(first), below: at(this.placed.length) - at(first + count), headings };
    this.column.follow(
      this.slots.map(({ block }) => block),
      shape,
      isMoved,
    );
  }

  /** Shows beside rules and checks what a robot says of them, by statement id. */
  showLive(states: ReadonlyMap<string, RuleState>): void {
    this.states = states;
    const { suggestions } = this.owner;
    const known = this.slots.flatMap(({ block, id }) => {
      const state = block.isDisposed() ? undefined : states.get(id);
      return state ? [[block, state] as const] : [];
    });
    this.badges.show(new Map(known), (check) =>
      suggestions.unit(String(check.getFieldValue("TOPIC")), String(check.getFieldValue("PROPERTY"))),
    );
  }

  /** Puts findings on the blocks of their statements. */
  mark(findings: readonly PlacedFinding[]): void {
    this.findings = findings;
    const statements = inPart(this.statements(), this.part);
    const missing = new Map<Blockly.BlockSvg, string>();
    for (const block of this.column.order) {
      const said = block.type === "adirf_raw" ? {} : toStatement(block);
      if ("missing" in said) missing.set(block, `Not in the text yet. ${said.missing}.`);
    }
    this.quietly(() => this.warnings.show(this.slots, statements, findings, missing));
    this.owner.leftOut(missing.size);
  }

  /** Shows which block says a statement, drawing it first; the focus stays where somebody works. */
  reveal(id: string | null): void {
    const index = id === null ? -1 : this.placed.findIndex(({ statement }) => statement.id === id);
    if (index >= 0 && !this.blockAt(index)) this.goTo(index);
    const block = this.blockAt(index);
    // Scrolling draws anew, so that each key stroke in one statement must not do it.
    if (block === this.revealed) return;
    this.revealed = block;
    this.workspace.highlightBlock(block?.id ?? null);
    if (block) this.column.bringIntoView(block);
  }

  private blockAt(index: number): Blockly.BlockSvg | null {
    return this.slots[index - this.part.first]?.block ?? null;
  }

  /** Unfolds the rule with this number, and puts the focus on it. */
  async unfold(index: number): Promise<void> {
    if (!(await this.settled())) return;
    const statement = this.placed[index]?.statement;
    if (statement === undefined) return;
    this.owner.folds.set(statement, false);
    if (this.blockAt(index)) this.showPart();
    this.goToBlock(index);
    this.lookSoon();
  }

  /** Puts the focus on the block of the statement with this number, drawing it first. */
  private goToBlock(index: number): void {
    if (!this.blockAt(index)) this.goTo(index);
    const block = this.blockAt(index);
    if (!block || block.isDisposed()) return;
    Blockly.getFocusManager().focusNode(block);
    this.column.bringIntoView(block);
  }

  /** Waits until the text says what blocks say; whether they are still shown then. */
  private async settled(): Promise<boolean> {
    while (!(await this.handOver(false)) || this.isAhead()) await new Promise(requestAnimationFrame);
    return !this.left;
  }

  private async toggleFold(block: Blockly.BlockSvg): Promise<void> {
    if (!(await this.settled())) return;
    const at = this.slots.findIndex((slot) => slot.block === block);
    const statement = this.placed[this.part.first + at]?.statement;
    // What is not in the text yet would be lost.
    if (at < 0 || statement === undefined || "missing" in (saidBy(block) ?? {})) return;
    this.owner.folds.set(statement, block.type !== FOLDED);
    this.letGoOfFocus();
    this.showPart();
    const shown = this.slots[at]?.block;
    if (shown) Blockly.getFocusManager().focusNode(shown.getField("FOLD") ?? shown);
    this.lookSoon();
  }

  /** Folds all rules to one line, or unfolds them; the first one in view stays there. */
  async foldAll(isFolded: boolean): Promise<void> {
    if (!(await this.settled())) return;
    const view = this.workspace.getMetricsManager().getViewMetrics(true);
    const at = this.slots.findIndex(({ block }) => block.getRelativeToSurfaceXY().y + block.height > view.top);
    const index = this.part.first + Math.max(at, 0);
    if (this.focusedAt() >= 0) this.letGoOfFocus();
    this.owner.folds.setAll(isFolded);
    this.part = partAround(index, this.placed.length);
    this.column.restart(GAP + (this.offsets()[this.part.first] ?? 0));
    this.showPart();
    const block = this.blockAt(index);
    if (block) this.column.bringIntoView(block);
    this.lookSoon();
  }

  /** Does something with a whole rule, once the text says what the blocks say. */
  private async act(block: Blockly.BlockSvg, act: RuleAct): Promise<void> {
    while (!(await this.handOver(false))) await new Promise(requestAnimationFrame);
    let done: ActedOn | null = null;
    await this.owner.changed((document) => {
      const slot = this.slots.findIndex((each) => each.block === block);
      const at = this.part.first + slot;
      const all = statementsOf(document);
      const said = all[at]?.statement;
      const isKnown = said !== undefined && fingerprint(said) === this.slots[slot]?.print;
      done = isKnown ? actedOn(all, at, act) : null;
      return done === null ? [] : [done.edit];
    });
    if (done !== null && !this.left) this.goToBlock((done as ActedOn).at);
  }

  setReadOnly(readOnly: boolean): void {
    this.workspace.setIsReadOnly(readOnly);
  }

  resize(): void {
    Blockly.svgResize(this.workspace);
  }

  focus(): void {
    Blockly.getFocusManager().focusTree(this.workspace);
  }

  /** Puts a new block where the text will have it, and opens its first field. */
  add(state: Blockly.serialization.blocks.State): void {
    const statements = this.statements();
    const rule = statements.findIndex(({ kind }) => kind === "rule");
    const beside = state.type === "adirf_rule" || rule < 0 ? statements.length - 1 : rule;
    if (!this.blockAt(beside)) this.goTo(beside);
    const block = Blockly.serialization.blocks.append(state, this.workspace) as Blockly.BlockSvg;
    this.column.add(block);
    this.column.bringIntoView(block);
    openField(
      block
        .getDescendants(true)
        .find((each) => each.getField("TOPIC"))
        ?.getField("TOPIC") ?? null,
    );
  }

  applyTheme(): void {
    this.workspace.setTheme(blocklyTheme(this.host));
  }

  /** Hands over what is not in the text yet, what is typed too, and removes the blocks. */
  dispose(): void {
    this.workspace.cancelCurrentGesture();
    closeField();
    const isAhead = this.isAhead();
    this.left = asOfNow(this.standing(), this.slots);
    if (isAhead) void this.hand();
    this.workspace.dispose();
  }

  private standing(): Standing {
    const { column } = this;
    return this.left ?? { order: column.order, isDropped: (block) => column.isDropped(block), says: saidBy };
  }

  private listen(event: Blockly.Events.Abstract): void {
    if (event.type === Blockly.Events.SELECTED) this.tellSelected();
    if (event.type === Blockly.Events.VIEWPORT_CHANGE) this.lookSoon();
    if (!event.isUiEvent) this.column.layOutSoon();
    if (!event.isUiEvent && !this.waiting) this.settleSoon();
  }

  private settleSoon(): void {
    this.waiting = true;
    this.owner.ahead(true);
    requestAnimationFrame(() => this.settle());
  }

  /** Whether somebody drags or types, so that blocks say what is not meant yet. */
  private isInHand(): boolean {
    return !this.left && (Blockly.Gesture.inProgress() || this.workspace.isDragging() || isTyping());
  }

  /** Waits until nobody drags or types, then says what changed. */
  private settle(): void {
    if (this.left) return;
    if (this.isInHand()) {
      this.settleSoon();
      return;
    }
    void this.hand();
  }

  /**
   * Brings into the text now what blocks say, before Blockly tells of it; whether nothing is left out.
   *
   * What somebody drags or types comes later.
   */
  async handOver(withOpenField: boolean): Promise<boolean> {
    if (this.left) return true;
    if (withOpenField) closeField();
    if (this.isInHand()) return false;
    await this.hand();
    return true;
  }

  private async hand(): Promise<void> {
    this.waiting = false;
    if (!this.left) {
      this.quietly(() => showJoins(this.workspace, this.owner.suggestions));
      this.mark(this.findings);
    }
    const handed = this.standing().order;
    this.underWay++;
    await this.owner.changed((document) => {
      if (this.isInHand()) {
        // Somebody went on while the edits before these were under way.
        this.settleSoon();
        return [];
      }
      const edits = editsOf(document, this.part.first, this.slots, this.standing());
      this.column.settle();
      return edits;
    });
    this.underWay--;
    if (!this.left) {
      this.takeBack(handed);
      this.owner.showAgain();
    }
    this.owner.ahead(this.isAhead());
  }

  /** Removes new blocks that did not come into the text: blocks say what the text says. */
  private takeBack(handed: readonly Blockly.BlockSvg[]): void {
    if (this.isAhead()) return;
    const taken = new Set(this.slots.map(({ block }) => block));
    const refused = handed.filter((block) => !block.isDisposed() && isTop(block) && !taken.has(block));
    this.quietly(() => {
      for (const block of refused) if (!("missing" in toStatement(block))) block.dispose(true);
    });
  }

  private tellSelected(): void {
    const selected = Blockly.common.getSelected();
    const block = selected instanceof Blockly.BlockSvg ? statementOf(selected) : null;
    this.owner.selected(this.slots.find((slot) => slot.block === block)?.id ?? null);
  }

  /** For each statement the block that shows it already. */
  private reuse(statements: Statement[], print: Print): (Blockly.BlockSvg | null)[] {
    const free = new Map<string, Blockly.BlockSvg[]>();
    for (const slot of this.slots) {
      const said = print(slot);
      if (said !== null) free.set(said, [...(free.get(said) ?? []), slot.block]);
    }
    return statements.map((statement) => {
      const isFolded = this.owner.folds.isFolded(statement);
      const equal = free.get(fingerprint(statement)) ?? [];
      const at = equal.findIndex(({ type }) => (type === FOLDED) === isFolded);
      return at < 0 ? null : (equal.splice(at, 1)[0] ?? null);
    });
  }

  private create(statement: Statement): Blockly.BlockSvg {
    const state = toBlock(statement, this.owner.folds.isFolded(statement));
    const block = Blockly.serialization.blocks.append(state, this.workspace) as Blockly.BlockSvg;
    if (statement.kind === "raw") showRawText(block, statement.text);
    return block;
  }

  private quietly(work: () => void): void {
    Blockly.Events.disable();
    try {
      work();
    } finally {
      Blockly.Events.enable();
    }
  }
}
