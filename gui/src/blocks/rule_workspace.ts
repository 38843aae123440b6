// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { PlacedFinding, RuleDocument, Statement, ZoneRectangle } from "../api/types";
import type { LostChanges } from "../state/rule_editor";
import type { Folds } from "../state/statements";
import { Badges } from "./badges";
import type { RuleAct } from "./block_types";
import { Column } from "./column";
import { DrawnPart, quietly, showJoins } from "./drawn_part";
import type { Suggestions } from "./fields";
import { FindingMarks } from "./finding_marks";
import type { RuleState } from "./live_states";
import type { MenuPage } from "./menus";
import { FOLDED, fingerprint, insideChecks, toBlock, toStatement } from "./model";
import { blocklyTheme, NEW_RATE, NEW_RULE, newWorkspace, setReadOnly } from "./new_workspace";
import { closeField, isElsewhere, isTyping, openField, scrollToBlock } from "./open_field";
import type { NewStatement } from "./rule_words";
import {
  type ActedOn,
  actedOn,
  asOfNow,
  bringLeft,
  type Changed,
  isTop,
  printOf,
  type Slot,
  type Standing,
  saidBy,
  statementOf,
  statementsOf,
  stepsOf,
} from "./slots";
import { rectangleOf } from "./zones";

const IN_HAND_MS = 50;

/** What the workspace tells and asks. */
interface WorkspaceOwner {
  suggestions: Suggestions;
  /** What the menus on blocks do with the page. */
  menus: Omit<MenuPage, "addStatement" | "foldAll">;
  /** Rules to take from the list of blocks; null where they cannot be had now. */
  recipes(): Promise<readonly Statement[] | null>;
  changed: Changed;
  /** What blocks said when they were left did not come into the text. */
  lost(lost: Omit<LostChanges, "name">): void;
  /** Whether blocks say something that is not in the text yet. */
  ahead(isAhead: boolean): void;
  tell(message: string): void;
  /** Lets somebody draw a zone of a statement anew. */
  drawZone(statement: string, rectangle: ZoneRectangle): void;
  /** Does the one-click fix of a finding. */
  mend(finding: PlacedFinding): void;
  /** Asks for `show` with what the text says now. */
  showAgain(): void;
  selected(statement: string | null): void;
  /** How many blocks say nothing that the text could say. */
  leftOut(count: number): void;
  folds: Folds;
}

/** Looks again whether somebody still types: a frame for each look would cost more than the letters. */
const lookAgain = (look: () => void) => void setTimeout(look, IN_HAND_MS);

/** The blocks of one rule file, kept in step with its text. */
export class RuleWorkspace {
  private readonly workspace: Blockly.WorkspaceSvg;
  private readonly column: Column;
  private readonly drawn: DrawnPart;
  private waiting = false;
  /** Blocks that came with a click, until somebody changes one or the text says them. */
  private readonly placeholders = new Set<string>();
  /** Changes of blocks that are on their way into the text. */
  private underWay = 0;
  private findings: readonly PlacedFinding[] = [];
  private isLooking = false;
  private readonly marks: FindingMarks;
  private revealed: Blockly.BlockSvg | null = null;
  private readonly badges = new Badges();
  private live: [ReadonlyMap<string, RuleState>, ReadonlySet<string>] = [new Map(), new Set()];
  /** What blocks said when somebody left them: nothing reads or changes a block after that. */
  private left: Standing | null = null;

  constructor(
    private readonly host: HTMLElement,
    private readonly owner: WorkspaceOwner,
  ) {
    const acts = {
      act: (block: Blockly.BlockSvg, what: RuleAct) => void this.act(block, what),
      toggleFold: (block: Blockly.BlockSvg) => void this.toggleFold(block),
      drawZone: (block: Blockly.BlockSvg) => void this.drawZone(block),
    };
    this.workspace = newWorkspace(host, owner.suggestions, () => owner.recipes(), acts, {
      ...owner.menus,
      foldAll: (isFolded) => void this.foldAll(isFolded),
      addStatement: (kind) => this.addStatement(kind),
    });
    this.column = new Column(this.workspace);
    this.drawn = new DrawnPart(this.workspace, this.column, owner, () => {
      this.mark(this.findings);
      this.showLive(...this.live);
    });
    this.marks = new FindingMarks((finding) => owner.mend(finding));
    this.workspace.addChangeListener((event) => this.listen(event));
  }

  /**
   * Shows a document, touching only the blocks of statements that changed.
   *
   * Does nothing while blocks are ahead of the text; it asks for another call then.
   */
  show(document: RuleDocument, sections: ReadonlyMap<number, string>): void {
    if (this.isAhead() || this.left) return;
    this.drawn.take(document, sections, printOf);
    this.lookSoon();
  }

  /** Shows a document that changed before what blocks say came into it; blocks that are ahead of it stay. */
  catchUp(document: RuleDocument): void {
    const { drawn } = this;
    if (document !== drawn.document && !this.left) drawn.take(document, drawn.sections, (slot) => slot.print);
  }

  /** Draws what came near the view, once nobody has anything in hand. */
  private lookSoon(): void {
    if (this.isLooking) return;
    this.isLooking = true;
    const look = () => {
      if (!this.left && (this.isInHand() || this.isAhead())) return lookAgain(look);
      this.isLooking = false;
      if (!this.left) this.drawn.look();
    };
    requestAnimationFrame(look);
  }

  /** Whether blocks say something that is not in the text yet. Blockly tells of a change a picture or two later. */
  private isAhead(): boolean {
    if (this.waiting || this.underWay > 0) return true;
    return !this.left && this.drawn.slots.some((slot) => (printOf(slot) ?? slot.print) !== slot.print);
  }

  /** Shows beside rules and checks what a robot says of them, by statement id, and which rules it has otherwise. */
  showLive(states: ReadonlyMap<string, RuleState>, differing: ReadonlySet<string>): void {
    this.live = [states, differing];
    const { suggestions } = this.owner;
    const known = this.drawn.slots.flatMap(({ block, id }) => {
      const state = block.isDisposed() ? undefined : states.get(id);
      return state ? [[block, state] as const] : [];
    });
    const others = this.drawn.slots.flatMap(({ block, id }) =>
      block.isDisposed() || !differing.has(id) ? [] : [block],
    );
    this.badges.show(new Map(known), others, (check) =>
      suggestions.unit(String(check.getFieldValue("TOPIC")), String(check.getFieldValue("PROPERTY"))),
    );
  }

  /** Puts findings on the blocks of their statements. */
  mark(findings: readonly PlacedFinding[]): void {
    this.findings = findings;
    const { slots, statements, all } = this.drawn;
    const missing = new Map<Blockly.BlockSvg, string>();
    for (const block of this.column.order) {
      const said = block.type === "adirf_raw" ? null : toStatement(block);
      if (said !== null && "missing" in said) missing.set(block, said.missing);
    }
    quietly(() => this.marks.show(slots, statements, findings, missing, all));
    this.owner.leftOut(missing.size);
  }

  /** Shows which block says a statement, drawing it first; the focus stays where somebody works. */
  reveal(id: string | null): void {
    const block = this.shownAt(id === null ? -1 : this.drawn.all.findIndex((statement) => statement.id === id));
    // Scrolling draws anew, so that each key stroke in one statement must not do it.
    if (block === this.revealed) return;
    this.revealed = block;
    this.workspace.highlightBlock(block?.id ?? null);
    if (block) scrollToBlock(block);
  }

  /** The block of the statement with this number; it is drawn unless blocks are ahead of the text. */
  private shownAt(index: number): Blockly.BlockSvg | null {
    if (index >= 0 && !this.drawn.blockAt(index) && !this.isAhead()) this.drawn.include(index);
    return this.drawn.blockAt(index);
  }

  /** Unfolds the rule with this number, and puts the focus on it. */
  async unfold(index: number): Promise<void> {
    if (!(await this.settled())) return;
    const statement = this.drawn.all[index];
    if (statement === undefined) return;
    this.owner.folds.set(statement, false);
    this.drawn.draw();
    this.goToBlock(index);
    this.lookSoon();
  }

  /** Puts the focus on the block of the statement with this number, drawing it first. */
  private goToBlock(index: number): void {
    const block = this.shownAt(index);
    if (!block || block.isDisposed()) return;
    Blockly.getFocusManager().focusNode(block);
    scrollToBlock(block);
  }

  /** Waits until the text says what blocks say; whether they are still shown then. */
  private async settled(): Promise<boolean> {
    while (!(await this.handOver(false)) || this.isAhead()) await new Promise(requestAnimationFrame);
    return !this.left;
  }

  private async toggleFold(block: Blockly.BlockSvg): Promise<void> {
    if (!(await this.settled())) return;
    const at = this.drawn.numberOf(block);
    const statement = this.drawn.all[at];
    // What is not in the text yet would be lost.
    if (statement === undefined || "missing" in (saidBy(block) ?? {})) return;
    this.owner.folds.set(statement, block.type !== FOLDED);
    this.drawn.letGoOfFocus();
    this.drawn.draw();
    const shown = this.drawn.blockAt(at);
    if (shown) Blockly.getFocusManager().focusNode(shown.getField("FOLD") ?? shown);
    this.lookSoon();
  }

  /** Lets somebody draw a zone anew, once the text says what the blocks say. */
  private async drawZone(block: Blockly.BlockSvg): Promise<void> {
    if (!(await this.settled()) || block.isDisposed()) return;
    const rectangle = rectangleOf(insideChecks(block));
    const slot = this.drawn.slots.find((each) => each.block === statementOf(block));
    if (slot && rectangle) this.owner.drawZone(slot.id, rectangle);
  }

  /** Folds all rules to one line, or unfolds them; the first one in view stays there. */
  async foldAll(isFolded: boolean): Promise<void> {
    if (!(await this.settled())) return;
    this.owner.folds.setAll(isFolded);
    const block = this.drawn.restart();
    if (block) scrollToBlock(block);
    this.lookSoon();
  }

  /** Does something with a whole rule, once the text says what the blocks say. */
  private async act(block: Blockly.BlockSvg, act: RuleAct): Promise<void> {
    while (!(await this.handOver(false))) await new Promise(requestAnimationFrame);
    let done: ActedOn | null = null;
    await this.owner.changed((document) => {
      const at = this.drawn.numberOf(block);
      const all = statementsOf(document);
      const said = all[at]?.statement;
      const isKnown = said !== undefined && fingerprint(said) === this.drawn.printAt(at);
      done = isKnown ? actedOn(all, at, act) : null;
      return done === null ? [] : [done.edit];
    });
    if (done === null || this.left || isElsewhere(this.workspace)) return;
    this.goToBlock((done as ActedOn).at);
  }

  setReadOnly(readOnly: boolean): void {
    setReadOnly(this.workspace, readOnly);
  }

  resize(): void {
    Blockly.svgResize(this.workspace);
    // A field that somebody types into goes with its block, which another part of the page must not cover.
    const field = Blockly.WidgetDiv.isVisible() ? Blockly.getFocusManager().getFocusedNode() : null;
    const block = field instanceof Blockly.Field ? field.getSourceBlock() : null;
    if (block instanceof Blockly.BlockSvg) scrollToBlock(block);
  }

  /** Adds a rule, or something else that holds outside of rules, which is to be changed. */
  addStatement(kind: NewStatement): void {
    if (kind === "rate") this.addDefault();
    else this.add(kind === "rule" ? toBlock(NEW_RULE) : { type: kind === "floor" ? "adirf_keep" : "adirf_within" });
  }

  /** Puts a new block where the text will have it, and opens its first field. */
  private add(state: Blockly.serialization.blocks.State): void {
    const { all } = this.drawn;
    const rule = all.findIndex(({ kind }) => kind === "rule");
    this.shownAt(state.type === "adirf_rule" || rule < 0 ? all.length - 1 : rule);
    const block = Blockly.serialization.blocks.append(state, this.workspace) as Blockly.BlockSvg;
    this.column.add(block);
    scrollToBlock(block);
    openField(
      block
        .getDescendants(true)
        .find((each) => each.getField("TOPIC"))
        ?.getField("TOPIC") ?? null,
    );
  }

  /** Adds a default for the first topic that has none yet, the robot's position before others. */
  private addDefault(): void {
    const said = this.column.order.flatMap((block) =>
      block.type === "adirf_set" ? [block.getFieldValue("TOPIC")] : [],
    );
    const taken = new Set([...said, ...this.drawn.all.flatMap((each) => (each.kind === "set" ? [each.topic] : []))]);
    const topics = [NEW_RATE.topic, ...this.owner.suggestions.topics()];
    const topic = topics.find((each) => !taken.has(each)) ?? NEW_RATE.topic;
    this.add(toBlock({ ...NEW_RATE, topic }));
  }

  applyTheme(): void {
    this.workspace.setTheme(blocklyTheme(this.host));
  }

  /** Hands over what is not in the text yet, what is typed too, and removes the blocks. */
  dispose(): void {
    this.workspace.cancelCurrentGesture();
    closeField();
    const isAhead = this.isAhead();
    this.left = asOfNow(this.standing(), this.drawn.slots);
    if (isAhead) void this.handLeft(this.left);
    this.workspace.dispose();
  }

  private standing(): Standing {
    const { column } = this;
    return this.left ?? { order: column.order, isDropped: (block) => column.isDropped(block), says: saidBy };
  }

  private listen(event: Blockly.Events.Abstract): void {
    if (event.type === Blockly.Events.SELECTED) this.reportSelected();
    if (event instanceof Blockly.Events.BlockCreate) for (const id of event.ids ?? []) this.placeholders.add(id);
    if (event instanceof Blockly.Events.BlockChange) this.placeholders.delete(event.blockId ?? "");
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
    if (this.isInHand()) lookAgain(() => this.settle());
    else void this.hand();
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
      quietly(() => showJoins(this.workspace, this.owner.suggestions));
      this.mark(this.findings);
    }
    const handed = this.standing().order;
    let before: Slot[] = [];
    let isPlaceholder = false;
    this.underWay++;
    await this.owner.changed(
      (document) => {
        if (this.left || this.isInHand()) {
          // What was left comes together; else somebody went on while the edits before these were under way.
          if (!this.left) this.settleSoon();
          return [];
        }
        before = this.drawn.slots.map((slot) => ({ ...slot }));
        isPlaceholder = this.placeholders.size > 0;
        this.placeholders.clear();
        const steps = stepsOf(document, this.drawn.first, this.drawn.slots, this.standing());
        this.column.settle();
        return steps.map(({ edit }) => edit);
      },
      (why) => {
        if (this.left) this.drawn.slots = before;
        else this.owner.tell(why);
      },
      () => isPlaceholder,
    );
    this.underWay--;
    if (!this.left) {
      this.takeBack(handed);
      this.owner.showAgain();
      if (isPlaceholder) this.reportSelected();
    }
    this.owner.ahead(this.isAhead());
  }

  /** Brings into the text what blocks said when they were left. */
  private async handLeft(left: Standing): Promise<void> {
    this.underWay++;
    const lost = await bringLeft(this.drawn, left, this.owner.changed);
    this.underWay--;
    if (lost !== null) this.owner.lost(lost);
    this.owner.ahead(false);
  }

  /** Removes new blocks that did not come into the text: blocks say what the text says. */
  private takeBack(handed: readonly Blockly.BlockSvg[]): void {
    if (this.isAhead()) return;
    const taken = new Set(this.drawn.slots.map(({ block }) => block));
    const refused = handed.filter((block) => !block.isDisposed() && isTop(block) && !taken.has(block));
    quietly(() => {
      for (const block of refused) if (!("missing" in toStatement(block))) block.dispose(true);
    });
  }

  private reportSelected(): void {
    const focused = Blockly.getFocusManager().getFocusedNode();
    const selected = focused instanceof Blockly.Field ? focused.getSourceBlock() : Blockly.common.getSelected();
    const block = selected instanceof Blockly.BlockSvg ? statementOf(selected) : null;
    this.owner.selected(this.drawn.slots.find((slot) => slot.block === block)?.id ?? null);
  }
}
