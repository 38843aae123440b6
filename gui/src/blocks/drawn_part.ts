// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { RuleDocument, Statement } from "../api/types";
import { checksOf, type Folds, statementsIn } from "../state/statements";
import { DEFAULT_TYPES } from "./action_model";
import { showRawText } from "./block_types";
import { type Column, GAP, HEADING } from "./column";
import { comparedIn } from "./compared";
import { type Suggestions, textOf } from "./fields";
import { hasNumbers, showNumbers, ZoneField } from "./inside_block";
import { FOLDED, fingerprint, toBlock } from "./model";
import { parseBound } from "./rule_words";
import { newSlot, printOf, type Slot, statementOf } from "./slots";
import { INSIDE } from "./zones";

type Print = (slot: Slot) => string | null;

/** The statements of a document, those of them that are blocks now, and where those stand. */
export class DrawnPart {
  slots: Slot[] = [];
  document: RuleDocument | null = null;
  all: readonly Statement[] = [];
  sections: ReadonlyMap<number, string> = new Map();
  private part: Part = { first: 0, count: 0, total: 0 };
  private readonly rows: Rows;

  constructor(
    private readonly workspace: Blockly.WorkspaceSvg,
    private readonly column: Column,
    private readonly owner: { folds: Folds; suggestions: Suggestions },
    private readonly drawn: () => void,
  ) {
    this.rows = new Rows((statement) => owner.folds.isFolded(statement));
  }

  /** The number of the first statement that is a block. */
  get first(): number {
    return this.part.first;
  }

  /** The statements that are blocks. */
  get statements(): Statement[] {
    return this.all.slice(this.part.first, this.part.first + this.part.count);
  }

  blockAt(index: number): Blockly.BlockSvg | null {
    return this.slots[index - this.first]?.block ?? null;
  }

  /** What the statement with this number means in the text. */
  printAt(index: number): string | undefined {
    return this.slots[index - this.first]?.print;
  }

  /** The number of the statement that a block is; -1 where it is none. */
  numberOf(block: Blockly.BlockSvg | null): number {
    const at = this.slots.findIndex((slot) => slot.block === block);
    return at < 0 ? -1 : this.first + at;
  }

  /** Draws a document; blocks whose `print` a statement has are those of the statement. */
  take(document: RuleDocument, sections: ReadonlyMap<number, string>, print: Print): void {
    const before = this.all;
    const all = statementsIn(document);
    const keys = (statements: readonly Statement[]) => statements.map(({ key = "" }) => key);
    this.owner.folds.follow(before, all);
    this.part = follow(this.part, keys(before), keys(all));
    this.document = document;
    this.all = all;
    this.sections = sections;
    if (before.length === 0) this.column.restart(this.begin);
    this.draw(print);
  }

  /** Draws the part around the statement with this number. */
  include(index: number): void {
    this.move(partAround(index, this.all.length));
  }

  /** Draws what came near the view. */
  look(): void {
    const { top: viewTop, height } = this.view;
    const offsets = this.offsets();
    const top = viewTop - this.column.top;
    const bottom = top + height;
    if (covers(this.part, partAt(offsets, top, bottom))) return;
    this.move(partAt(offsets, top - height / 2, bottom + height / 2));
  }

  /** Draws all anew after other rules are folded; returns the block that was the first in view. */
  restart(): Blockly.BlockSvg | null {
    const { top } = this.view;
    const at = this.slots.findIndex(({ block }) => block.getRelativeToSurfaceXY().y + block.height > top);
    const index = this.first + Math.max(at, 0);
    if (this.focusedAt() >= 0) this.letGoOfFocus();
    this.part = partAround(index, this.all.length);
    this.column.restart(this.begin + (this.offsets()[this.first] ?? 0));
    this.draw();
    return this.blockAt(index);
  }

  draw(print: Print = printOf, isMoved = false): void {
    const { statements } = this;
    // Between two parts there is less to scroll over, which must not move the view. The column allows it again.
    this.workspace.setResizesEnabled(false);
    quietly(() => {
      const reused = this.reuse(statements, print);
      const isSameCount = statements.length === this.slots.length;
      const open = this.slots.map(({ block }) => isSameCount && block.getDescendants(false).some(hasNumbers));
      const old = new Set(this.slots.map((slot) => slot.block));
      for (const block of reused) if (block) old.delete(block);
      for (const block of old) if (!block.isDisposed()) block.dispose(true);
      this.slots = statements.map((statement, index) =>
        newSlot(reused[index] ?? this.create(statement, open[index]), statement),
      );
      showJoins(this.workspace, this.owner.suggestions);
    });
    this.arrange(isMoved);
    this.rows.measure(statements, this.slots);
    this.drawn();
  }

  /** Blockly gives the focus of a block that goes to a neighbour, a little later, and scrolls there. */
  letGoOfFocus(): void {
    Blockly.getFocusManager().focusNode(this.workspace);
  }

  private get view(): { top: number; height: number } {
    return this.workspace.getMetricsManager().getViewMetrics(true);
  }

  private get begin(): number {
    return GAP + (this.sections.has(0) ? HEADING : 0);
  }

  /** Draws another part of the text; what both have stays where it is. */
  private move(part: Part): void {
    const { first, count } = this.part;
    const end = part.first + part.count;
    const isApart = part.first >= first + count || first >= end;
    if (isApart) this.column.restart(this.column.top + (this.offsets()[part.first] ?? 0));
    const focused = this.focusedAt();
    if (focused >= 0 && (focused < part.first || focused >= end)) this.letGoOfFocus();
    this.part = part;
    this.draw(printOf, true);
  }

  /** The number of the statement whose block has the focus. */
  private focusedAt(): number {
    const node = Blockly.getFocusManager().getFocusedNode();
    const block = node instanceof Blockly.Field ? node.getSourceBlock() : node;
    return this.numberOf(block instanceof Blockly.BlockSvg ? statementOf(block) : null);
  }

  private offsets(): number[] {
    return this.rows.offsets(this.all, this.sections);
  }

  private arrange(isMoved: boolean): void {
    const { first, count } = this.part;
    const offsets = this.offsets();
    const at = (index: number) => offsets[index] ?? 0;
    const blocks = this.slots.map(({ block }) => block);
    const headings = new Map<Blockly.BlockSvg, string>();
    blocks.forEach((block, index) => {
      const words = this.sections.get(first + index);
      if (words !== undefined) headings.set(block, words);
    });
    const below = at(this.all.length) - at(first + count);
    this.column.follow(blocks, { above: at(first), below, headings }, isMoved);
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

  private create(statement: Statement, isOpen = false): Blockly.BlockSvg {
    const state = toBlock(statement, this.owner.folds.isFolded(statement));
    const block = Blockly.serialization.blocks.appendInternal(state, this.workspace) as Blockly.BlockSvg;
    if (statement.kind === "raw") showRawText(block, statement.text);
    const zones = block.getDescendants(false).filter(({ type }) => isOpen && type === INSIDE);
    for (const zone of zones) showNumbers(zone, true);
    return block;
  }
}

/** Does something that Blockly tells nobody of. */
export function quietly(work: () => void): void {
  Blockly.Events.disable();
  try {
    work();
  } finally {
    Blockly.Events.enable();
  }
}

/** The height of one line of a block, before any was drawn. */
const LINE = 48;

/** How much room statements need in the column, in the units of the canvas: as they were drawn, else about so much. */
class Rows {
  private readonly drawn = new Map<string, number>();

  constructor(private readonly isFolded: (statement: Statement) => boolean) {}

  measure(statements: readonly Statement[], slots: readonly Slot[]): void {
    slots.forEach(({ block }, index) => {
      const statement = statements[index];
      if (statement && block.height > 0) this.drawn.set(this.look(statement), block.height);
    });
  }

  /** Where each statement begins below the top of the column, and where the last one ends. */
  offsets(statements: readonly Statement[], sections: ReadonlyMap<number, string>): number[] {
    return offsetsOf(
      statements.map((statement, index) => {
        const next = statements[index + 1];
        const hangs = next && isDefault(statement) && isDefault(next) && !sections.has(index + 1);
        const heading = sections.has(index + 1) ? HEADING : 0;
        return (this.drawn.get(this.look(statement)) ?? this.guess(statement)) + (hangs ? 0 : GAP) + heading;
      }),
    );
  }

  private look(statement: Statement): string {
    if (statement.kind !== "rule") return statement.kind;
    return this.isFolded(statement) ? "folded" : `${statement.key}`;
  }

  private guess(statement: Statement): number {
    if (statement.kind !== "rule" || this.isFolded(statement)) return LINE;
    const parts = checksOf(statement.condition).length + statement.then.length + statement.else.length;
    return LINE * (4 + parts);
  }
}

function isDefault({ kind }: Statement): boolean {
  return DEFAULT_TYPES.has(`adirf_${kind}`);
}

/** A text with no more statements than this is shown whole: Blockly keeps every block drawn. */
const WHOLE = 40;

/** The statements that are blocks now, of a longer text those near the view; counted from 0 in the order of the text. */
interface Part {
  readonly first: number;
  readonly count: number;
  readonly total: number;
}

export function partAround(index: number, total: number): Part {
  if (total <= WHOLE) return { first: 0, count: total, total };
  const first = Math.max(0, Math.min(index - WHOLE / 4, total - WHOLE / 2));
  return { first, count: Math.min(WHOLE / 2, total - first), total };
}

/** The part after a change of the text, by the keys of its statements: what comes or goes in it changes its length. */
export function follow(part: Part, before: readonly string[], after: readonly string[]): Part {
  const total = after.length;
  if (total <= WHOLE || part.total === 0) return partAround(0, total);
  const more = total - part.total;
  const changed = before.findIndex((key, index) => key !== after[index]);
  const at = changed < 0 ? before.length : changed;
  const first = at < part.first ? part.first + more : part.first;
  const isIn = at >= part.first && at <= part.first + part.count;
  const count = isIn ? part.count + more : part.count;
  const isPart = first >= 0 && count > 0 && first + count <= total;
  return isPart ? { first, count, total } : partAround(Math.min(at, total - 1), total);
}

/** The tops of rows with these heights, the end of the last one included. */
export function offsetsOf(heights: readonly number[]): number[] {
  let y = 0;
  return [0, ...heights.map((height) => (y += height))];
}

/** The rows that a stretch of the column needs; of a short text all. */
export function partAt(offsets: readonly number[], top: number, bottom: number): Part {
  const total = offsets.length - 1;
  if (total <= WHOLE) return { first: 0, count: total, total };
  const above = offsets.findLastIndex((y) => y <= top);
  const below = offsets.findIndex((y) => y >= bottom);
  const first = Math.min(Math.max(above, 0), total - 1);
  const last = below < 0 ? total : Math.max(below, first + 1);
  return { first, count: last - first, total };
}

export function covers(part: Part, other: Part): boolean {
  return part.first <= other.first && other.first + other.count <= part.first + part.count;
}

const CONDITIONS = new Set(["adirf_check", "adirf_all", "adirf_any", "adirf_not", INSIDE]);

/** Writes AND or OR before every check that stands below another, and units behind values and bounds. */
export function showJoins(workspace: Blockly.WorkspaceSvg, suggest: Suggestions): void {
  for (const block of workspace.getAllBlocks(false)) {
    if (block.isInsertionMarker()) continue;
    if (CONDITIONS.has(block.type)) write(block, "JOIN", joinOf(block));
    const zone = block.getField("ZONE");
    if (zone instanceof ZoneField) zone.refresh();
    if (block.getField("BY_UNIT")) {
      write(block, "BY_UNIT", suggest.unit(textOf(block, "BY_TOPIC"), textOf(block, "BY_PROPERTY")));
    }
    if (block.type !== "adirf_check" && block.type !== "adirf_within") continue;
    const unit = suggest.unit(textOf(block, "TOPIC"), textOf(block, "PROPERTY"));
    const isLevel = typeof parseBound(textOf(block, "BOUND")) === "string";
    write(block, "UNIT", isLevel || isWord(block, "VALUE") ? "" : unit);
    write(block, "UNTIL_UNIT", isWord(block, "UNTIL_VALUE") ? "" : unit);
  }
}

/** Whether a check compares with something else than a number, which has no unit. */
function isWord(block: Blockly.Block, field: string): boolean {
  return block.getField(field) !== null && typeof comparedIn(block.getFieldValue(field)) === "string";
}

function write(block: Blockly.Block, name: string, text: string): void {
  if (block.getField(name) && block.getFieldValue(name) !== text) block.setFieldValue(text, name);
}

function joinOf(block: Blockly.Block): string {
  const above = block.getPreviousBlock();
  if (!above || above === block.getSurroundParent()) return "";
  return block.getSurroundParent()?.type === "adirf_any" ? "OR" : "AND";
}
