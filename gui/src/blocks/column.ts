// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { DEFAULT_TYPES } from "./action_model";
import { FOLDED } from "./model";
import { scrollToBlock } from "./open_field";
import { statementOf } from "./slots";

type Block = Blockly.BlockSvg;

export const GAP = 18;
/** The room for the words above a section. */
export const HEADING = 34;
/** Left of it is the room for marks. */
const LEFT = 40;
const GLIDE_MS = 160;

/** What stands around and between the blocks of a part of the text. */
interface Shape {
  /** The heights of what is not drawn, in the units of the canvas. */
  readonly above: number;
  readonly below: number;
  /** The words above the first blocks of sections. */
  readonly headings: ReadonlyMap<Block, string>;
}

/**
 * The blocks of a workspace, one below the other in the order of the text.
 *
 * What the text does not say keeps its place among the others. Blockly's own pushing of neighbours is off.
 */
export class Column {
  private blocks: Block[] = [];
  /** Where somebody let go of blocks, until the text knows it. */
  private readonly dropped = new Set<Block>();
  /** Blocks that had a place, from which they glide. */
  private placed = new Set<Block>();
  private first = GAP;
  private isDue = false;
  private shape: Shape = { above: 0, below: 0, headings: new Map() };
  private readonly drawnHeadings: SVGElement[] = [];

  constructor(private readonly workspace: Blockly.WorkspaceSvg) {
    for (const definition of Object.values(Blockly.Blocks)) this.lendTo(definition);
    const drawn = workspace.getBlocksBoundingBox.bind(workspace);
    workspace.getBlocksBoundingBox = () => {
      const { top, bottom, left, right } = drawn();
      const { above, below, headings } = this.shape;
      const heading = headings.has(this.blocks[0] as Block) ? HEADING : 0;
      return new Blockly.utils.Rect(top - above - heading, bottom + below, left, right);
    };
  }

  /** Where the column begins, with what is not drawn above its first block. */
  get top(): number {
    return this.first - this.shape.above;
  }

  /** All statements and what could become some, from above. */
  get order(): readonly Block[] {
    this.takeIn();
    return this.blocks;
  }

  /** Whether somebody dragged this block to its place, and the text does not know yet. */
  isDropped(block: Block): boolean {
    return this.dropped.has(block);
  }

  /** The text knows where blocks were dropped. */
  settle(): void {
    this.dropped.clear();
  }

  /** Puts a new block where the text will have it. */
  add(block: Block): void {
    this.insert(block, usualPlace(this.blocks, block));
    this.layOut();
  }

  /** Takes over the order of the text; `isMoved` is whether another part of it is drawn, which leaves the rest where it is. */
  follow(text: readonly Block[], shape: Shape, isMoved: boolean): void {
    const known = text.filter((block) => !this.dropped.has(block));
    this.blocks = withLoose(known, this.blocks);
    this.shape = shape;
    const anchor = isMoved ? text.find((block) => this.placed.has(block)) : undefined;
    this.layOut(anchor);
  }

  /** Draws the first block there, as of another part of the text. */
  restart(top: number): void {
    this.first = top;
    this.placed.clear();
  }

  /** Lays all blocks out before the next picture, or once nobody holds one any more. */
  layOutSoon(): void {
    if (this.isDue) return;
    this.isDue = true;
    queueMicrotask(() => this.layOutNow());
  }

  private layOutNow(): void {
    if (this.isHeld()) {
      requestAnimationFrame(() => this.layOutNow());
      return;
    }
    this.isDue = false;
    if (this.workspace.rendered) this.layOut();
  }

  /** Whether a block may be in somebody's hand: a block out of the list is there before it is dragged. */
  private isHeld(): boolean {
    return Blockly.Gesture.inProgress() || this.workspace.isDragging();
  }

  /** Lets blocks tell when they were drawn, instead of pushing their neighbours, and when somebody let go of them. */
  private lendTo(definition: object): void {
    const column = this;
    Object.assign(definition, {
      bumpNeighbours(this: Block) {
        if (this.workspace === column.workspace) column.layOutSoon();
      },
      endDrag(this: Block, ...how: Parameters<Block["endDrag"]>) {
        Blockly.BlockSvg.prototype.endDrag.apply(this, how);
        if (this.workspace === column.workspace) column.drop(this);
      },
    });
  }

  private drop(block: Block): void {
    const chain = chainFrom(block).filter(isStanding);
    for (const each of chain) this.dropped.add(each);
    const rest = this.blocks.filter((each) => !this.dropped.has(each));
    const above = block.getPreviousBlock();
    const below = chain.at(-1)?.getNextBlock() ?? null;
    if (above) this.blocks = rest.toSpliced(rest.indexOf(above) + 1, 0, ...chain);
    else {
      const boxes = rest.map((each) => ({ top: topOf(each), height: each.height }));
      const at = below ? rest.indexOf(below) : dropIndex(boxes, topOf(block));
      this.blocks = rest.toSpliced(at, 0, ...chain);
    }
    this.layOutSoon();
  }

  /** Brings the list to the blocks that there are; returns the new ones. */
  private takeIn(): Block[] {
    this.blocks = this.blocks.filter(isStanding);
    if (this.isHeld()) return [];
    const known = new Set(this.blocks);
    const fresh = this.workspace
      .getTopBlocks(true)
      .flatMap(chainFrom)
      .filter((block) => !known.has(block) && isStanding(block));
    for (const block of fresh) this.insert(block, this.placeOf(block));
    return fresh;
  }

  private insert(block: Block, at: number): void {
    this.blocks.splice(at, 0, block);
  }

  /** The place of a block that came by a click or was pasted: behind one of its kind that begins above it. */
  private placeOf(block: Block): number {
    const chained = block.getPreviousBlock();
    if (chained && this.blocks.includes(chained)) return this.blocks.indexOf(chained) + 1;
    const above = this.blocks.findLastIndex((each) => topOf(each) <= topOf(block));
    const isOfKind = above >= 0 && isRule(this.blocks[above] as Block) === isRule(block);
    return isOfKind ? above + 1 : usualPlace(this.blocks, block);
  }

  private layOut(anchor?: Block): void {
    const fresh = this.takeIn();
    Blockly.Events.disable();
    this.workspace.setResizesEnabled(false);
    const { headings } = this.shape;
    const hangs = ({ type }: Block) => DEFAULT_TYPES.has(type);
    const stacks = stacksOf(this.blocks, hangs, (block) => headings.has(block));
    const before = new Map(this.blocks.map((block) => [block, block.getRelativeToSurfaceXY()]));
    for (const stack of stacks) hangTogether(stack);
    // A block has no size before it is drawn.
    Blockly.renderManagement.triggerQueuedRenders(this.workspace);
    const heads = stacks.map(([head]) => head as Block);
    const heights = heads.map((head, index) => {
      const next = heads[index + 1];
      return head.getHeightWidth().height + (next && headings.has(next) ? HEADING : 0);
    });
    const tops = topsOf(heights, GAP, this.first, this.pinned(stacks, before, anchor));
    this.first = tops[0] ?? GAP;
    heads.forEach((head, index) => {
      this.place(head, tops[index] ?? GAP, before.get(head));
    });
    this.placed = new Set(this.blocks);
    this.drawHeadings();
    this.workspace.setResizesEnabled(true);
    Blockly.Events.enable();
    const [newest] = fresh.slice(-1);
    if (newest) scrollToBlock(newest);
  }

  private drawHeadings(): void {
    const wanted = [...this.shape.headings].filter(([block]) => !block.isDisposed());
    for (const drawn of this.drawnHeadings.splice(wanted.length)) drawn.remove();
    while (this.drawnHeadings.length < wanted.length) {
      const look = { class: "section-heading", x: LEFT };
      const { createSvgElement } = Blockly.utils.dom;
      this.drawnHeadings.push(createSvgElement(Blockly.utils.Svg.TEXT, look, this.workspace.getCanvas()));
    }
    wanted.forEach(([block, words], index) => {
      const text = this.drawnHeadings[index] as SVGElement;
      const y = String(topOf(block) - GAP / 2);
      if (text.getAttribute("y") !== y) text.setAttribute("y", y);
      if (text.textContent !== words) text.textContent = words;
    });
  }

  /** The stack that somebody types in, or that of `anchor`, which stays where it is on the screen. */
  private pinned(
    stacks: readonly Block[][],
    before: ReadonlyMap<Block, Blockly.utils.Coordinate>,
    anchor: Block | undefined,
  ): { index: number; top: number } | null {
    const focused = Blockly.getFocusManager().getFocusedNode();
    const block = focused instanceof Blockly.Field ? focused.getSourceBlock() : focused;
    const isTyped = block instanceof Blockly.BlockSvg && Blockly.WidgetDiv.isVisible();
    const pin = isTyped ? statementOf(block) : anchor;
    if (pin === undefined) return null;
    const index = stacks.findIndex((stack) => stack.includes(pin));
    const head = stacks[index]?.[0];
    if (head === undefined || !this.placed.has(pin)) return null;
    return { index, top: (before.get(pin)?.y ?? GAP) - (topOf(pin) - topOf(head)) };
  }

  private place(head: Block, top: number, before: Blockly.utils.Coordinate | undefined): void {
    head.moveTo(new Blockly.utils.Coordinate(LEFT, top));
    const isFar = before !== undefined && Math.hypot(before.x - LEFT, before.y - top) > 1;
    if (!isFar || !this.placed.has(head) || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const at = (x: number, y: number) => ({ transform: `translate(${x}px, ${y}px)` });
    head.getSvgRoot().animate([at(before.x, before.y), at(LEFT, top)], { duration: GLIDE_MS, easing: "ease-out" });
  }
}

/** Connects blocks of one stack, and nothing else with them. */
function hangTogether(stack: readonly Block[]): void {
  stack.forEach((block, index) => {
    const above = stack[index - 1] ?? null;
    if (block.getPreviousBlock() !== above) block.previousConnection?.disconnect();
  });
  stack.forEach((block, index) => {
    const above = stack[index - 1];
    if (!above || block.getPreviousBlock() === above || !block.previousConnection) return;
    above.nextConnection?.connect(block.previousConnection);
  });
}

/** Where the text has a new statement: defaults and floors before the first rule, rules at the end. */
function usualPlace(blocks: readonly Block[], block: Block): number {
  const rule = blocks.findIndex(isRule);
  return isRule(block) || rule < 0 ? blocks.length : rule;
}

function isRule({ type }: Block): boolean {
  return type === "adirf_rule" || type === FOLDED;
}

function chainFrom(head: Block): Block[] {
  const chain: Block[] = [];
  for (let block: Block | null = head; block; block = block.getNextBlock()) chain.push(block);
  return chain;
}

/** Whether a block is there, and in no other. */
function isStanding(block: Block): boolean {
  return !block.isDisposed() && !block.isInsertionMarker() && block.getSurroundParent() === null;
}

function topOf(block: Block): number {
  return block.getRelativeToSurfaceXY().y;
}

/** The tops of stacks with these heights, one below the other; a pinned stack keeps its top, else the first starts at `first`. */
export function topsOf(
  heights: readonly number[],
  gap: number,
  first: number,
  pin: { index: number; top: number } | null = null,
): number[] {
  let y = 0;
  const tops = heights.map((height) => {
    const top = y;
    y += height + gap;
    return top;
  });
  const start = pin === null ? first : pin.top - (tops[pin.index] ?? 0);
  return tops.map((top) => start + top);
}

/** The things of the text in its order, and each other thing behind what it stood behind. */
export function withLoose<T>(text: readonly T[], before: readonly T[]): T[] {
  const order = [...text];
  const known = new Set(text);
  before.forEach((each, index) => {
    if (known.has(each)) return;
    known.add(each);
    const above = before.slice(0, index).findLast((other) => known.has(other));
    order.splice(above === undefined ? 0 : order.indexOf(above) + 1, 0, each);
  });
  return order;
}

/** The place of what is dropped with its upper edge at `y`, among things that are one below the other. */
export function dropIndex(things: readonly { top: number; height: number }[], y: number): number {
  const below = things.findIndex(({ top, height }) => y < top + height / 2);
  return below < 0 ? things.length : below;
}

/** Neighbours that hang together, in stacks; one that begins something hangs on nothing above it. */
export function stacksOf<T>(
  order: readonly T[],
  hangs: (thing: T) => boolean,
  begins: (thing: T) => boolean = () => false,
): T[][] {
  const stacks: T[][] = [];
  order.forEach((each, index) => {
    const above = order[index - 1];
    if (above !== undefined && hangs(above) && hangs(each) && !begins(each)) stacks.at(-1)?.push(each);
    else stacks.push([each]);
  });
  return stacks;
}
