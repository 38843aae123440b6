// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Edit, PlacedCollection, RuleDocument, Statement } from "../api/types";
import type { LostChanges } from "../state/rule_editor";
import type { RuleAct } from "./block_types";
import { fingerprint, toStatement } from "./model";
import { statementTitle } from "./rule_words";

/** A statement of the text and the block that shows it. */
export interface Slot {
  readonly block: Blockly.BlockSvg;
  /** What the statement means in the text, to see whether the block says something else now. */
  print: string;
  id: string;
  key: string;
  comments: string | null;
}

/** A statement with its place in the text. */
interface Placed {
  statement: Statement;
  collection: PlacedCollection;
  index: number;
}

/** All statements in the order of the text. */
export function statementsOf(document: RuleDocument): Placed[] {
  return placedIn(document.collections);
}

function placedIn(collections: PlacedCollection[]): Placed[] {
  return collections.flatMap((collection) =>
    collection.statements.map((statement, index) => ({ statement, collection, index })),
  );
}

export function newSlot(block: Blockly.BlockSvg, statement: Statement): Slot {
  return {
    block,
    print: fingerprint(statement),
    id: statement.id ?? "",
    key: statement.key ?? "",
    comments: statement.comments?.join("\n") ?? null,
  };
}

/** The statements that blocks stand for, and where those are. */
export interface Standing {
  /** All blocks that are statements of their own, or could become some, in the order of the canvas. */
  readonly order: readonly Blockly.BlockSvg[];
  /** Whether somebody dragged a block to its place. */
  isDropped(block: Blockly.BlockSvg): boolean;
  /** What a block says as a statement of its own; null where it is none any more. */
  says(block: Blockly.BlockSvg): Said;
}

type Said = Statement | { missing: string } | null;

/**
 * Blocks say something else than the text: `editsOf` it bring it there; `refused` hears why not, instead of the page;
 * `isPlaceholder` is whether that is something new, which is to be changed.
 */
export type Changed = (
  editsOf: (document: RuleDocument) => Edit[],
  refused?: (why: string) => void,
  isPlaceholder?: () => boolean,
) => Promise<void>;

/** An edit, and the block that says it. */
interface Step {
  readonly edit: Edit;
  readonly block: Blockly.BlockSvg;
}

/** The edits, one after the other and at `most` so many, that bring the text to what the blocks say; as `nextStep` for each. */
export function stepsOf(
  document: RuleDocument,
  first: number,
  slots: Slot[],
  standing: Standing,
  most = Number.POSITIVE_INFINITY,
): Step[] {
  const steps: Step[] = [];
  let collections = document.collections;
  while (steps.length < most) {
    const step = nextStep(collections, first, slots, standing);
    if (step === null) break;
    steps.push(step);
    collections = edited(collections, step.edit);
  }
  return steps;
}

/**
 * The next edit that brings the text to what the blocks say; null when they agree, or when the text is
 * no longer the one that the slots know.
 *
 * `first` is the number of the first slot's statement. `slots` is in the order of the text and is changed as if the edit were done.
 */
function nextStep(collections: PlacedCollection[], first: number, slots: Slot[], standing: Standing): Step | null {
  const places = placedIn(collections).slice(first, first + slots.length);
  const isKnown = slots.every((slot, index) => slot.print === printAt(places, index));
  if (places.length !== slots.length || !isKnown) return null;
  slots.forEach((slot, index) => {
    slot.id = places[index]?.statement.id ?? "";
  });
  return (
    nextDelete(slots, standing) ??
    nextReplace(slots, standing) ??
    nextInsert(collections[0], places, slots, standing) ??
    nextMove(places, slots, standing)
  );
}

function printAt(places: Placed[], index: number): string | null {
  const place = places[index];
  return place ? fingerprint(place.statement) : null;
}

function nextDelete(slots: Slot[], { says }: Standing): Step | null {
  const index = slots.findIndex(({ block }) => says(block) === null);
  const [slot] = index < 0 ? [] : slots.splice(index, 1);
  return slot ? { edit: { kind: "delete", id: slot.id }, block: slot.block } : null;
}

function nextReplace(slots: Slot[], { says }: Standing): Step | null {
  for (const slot of slots) {
    const statement = says(slot.block);
    if (statement === null || "missing" in statement) continue;
    const print = fingerprint(statement);
    if (print === slot.print) continue;
    slot.print = print;
    const comments = statement.comments?.join("\n") ?? null;
    const known = comments === slot.comments;
    slot.comments = comments;
    const written = { ...statement, comments: known ? null : (statement.comments ?? []) };
    return { edit: { kind: "replace", id: slot.id, statement: written }, block: slot.block };
  }
  return null;
}

function nextInsert(
  fallback: PlacedCollection | undefined,
  places: Placed[],
  slots: Slot[],
  { order, says }: Standing,
): Step | null {
  for (const block of order) {
    if (slotOf(slots, block) >= 0) continue;
    const statement = says(block);
    if (statement === null || "missing" in statement) continue;
    const at = slotAbove(slots, order, block) + 1;
    const target = collectionAt(places, at, fallback);
    if (target === null) continue;
    slots.splice(at, 0, newSlot(block, statement));
    return { edit: { kind: "insert", collection: target.id, index: target.index, statement }, block };
  }
  return null;
}

function slotOf(slots: readonly Slot[], block: Blockly.Block): number {
  return slots.findIndex((slot) => slot.block === block);
}

/** The slot of the nearest block above that is in the text; -1 where there is none. */
function slotAbove(slots: readonly Slot[], order: readonly Blockly.BlockSvg[], block: Blockly.BlockSvg): number {
  const above = order.slice(0, order.indexOf(block)).findLast((each) => slotOf(slots, each) >= 0);
  return above ? slotOf(slots, above) : -1;
}

function collectionAt(
  places: Placed[],
  at: number,
  fallback: PlacedCollection | undefined,
): { id: string; index: number } | null {
  const before = places[at - 1];
  if (before) return { id: before.collection.id, index: before.index + 1 };
  const [first] = places;
  if (first) return { id: first.collection.id, index: first.index };
  return fallback ? { id: fallback.id, index: 0 } : null;
}

function nextMove(places: Placed[], slots: Slot[], { order, isDropped }: Standing): Step | null {
  for (const block of order.filter(isDropped)) {
    const here = slotOf(slots, block);
    const above = slotAbove(slots, order, block);
    if (here < 0 || above === here - 1) continue;
    const [slot] = slots.splice(here, 1);
    const target = places[Math.max(above, 0)];
    if (!slot || !target) continue;
    const isDown = here < above;
    slots.splice(isDown ? above : above + 1, 0, slot);
    const isOut = isDown && places[here]?.collection === target.collection;
    const index = target.index + (above < 0 || isOut ? 0 : 1);
    return { edit: { kind: "move", id: slot.id, collection: target.collection.id, index }, block };
  }
  return null;
}

/** Whether a block is a statement of its own: not inside another block. */
export function isTop(block: Blockly.Block): boolean {
  return block.getSurroundParent() === null;
}

/** The statement that a block belongs to, which may be itself. */
export function statementOf(block: Blockly.BlockSvg): Blockly.BlockSvg {
  const around = block.getSurroundParent();
  return around ? statementOf(around) : block;
}

/** What a block says now as a statement of its own. */
export function saidBy(block: Blockly.BlockSvg): Said {
  return block.isDisposed() || !isTop(block) ? null : toStatement(block);
}

/** The meaning of what the block of a slot says now, null where that is nothing that a text could say. */
export function printOf({ block }: Slot): string | null {
  const said = saidBy(block);
  return said === null || "missing" in said ? null : fingerprint(said);
}

/** The statements after an edit by the blocks, numbered as the server will number them. */
export function edited(collections: PlacedCollection[], edit: Edit): PlacedCollection[] {
  const lists = new Map(collections.map(({ id, statements }) => [id, [...statements]]));
  switch (edit.kind) {
    case "delete":
      takeOut(lists, edit.id);
      break;
    case "replace":
      replace(lists, edit.id, edit.statement);
      break;
    case "insert":
      lists.get(edit.collection)?.splice(edit.index, 0, edit.statement);
      break;
    case "move": {
      const statement = takeOut(lists, edit.id);
      if (statement) lists.get(edit.collection)?.splice(edit.index, 0, statement);
    }
  }
  let number = 0;
  return collections.map((collection) => ({
    ...collection,
    statements: (lists.get(collection.id) ?? []).map((statement) => ({ ...statement, id: `s${++number}` })),
  }));
}

type Lists = ReadonlyMap<string, Statement[]>;

function takeOut(lists: Lists, id: string): Statement | undefined {
  for (const statements of lists.values()) {
    const index = statements.findIndex((each) => each.id === id);
    if (index >= 0) return statements.splice(index, 1)[0];
  }
  return undefined;
}

function replace(lists: Lists, id: string, statement: Statement): void {
  for (const statements of lists.values()) {
    const index = statements.findIndex((each) => each.id === id);
    const old = statements[index];
    if (old) statements[index] = { ...statement, comments: statement.comments ?? old.comments ?? null };
  }
}

/** An edit of the text, and the number of the statement that it is about once it is done. */
export interface ActedOn {
  edit: Edit;
  at: number;
}

/** What an act on the rule that is number `at` does to the text; null where there is nothing to do. */
export function actedOn(all: readonly Placed[], at: number, act: RuleAct): ActedOn | null {
  const place = all[at];
  if (place?.statement.kind !== "rule") return null;
  const { statement, collection, index } = place;
  const id = statement.id ?? "";
  switch (act) {
    case "switch": {
      const is_disabled = !statement.is_disabled;
      return { edit: { kind: "replace", id, statement: { ...statement, is_disabled, comments: null } }, at };
    }
    case "duplicate":
      return { edit: { kind: "duplicate", id }, at: at + 1 };
    case "up":
    case "down": {
      const to = index + (act === "up" ? -1 : 1);
      if (to < 0 || to >= collection.statements.length) return null;
      return { edit: { kind: "move", id, collection: collection.id, index: to }, at: at + to - index };
    }
  }
}

/** What blocks say now, for a time at which they are gone. */
export function asOfNow({ order, isDropped, says }: Standing, slots: readonly Slot[]): Standing {
  const all = new Set([...order, ...slots.map(({ block }) => block)]);
  const said = new Map([...all].map((block) => [block, says(block)]));
  const dropped = new Set([...all].filter(isDropped));
  return { order: [...order], isDropped: (block) => dropped.has(block), says: (block) => said.get(block) ?? null };
}

/**
 * Brings into the text what blocks said when they were left: all at once, else one by one all that is not refused.
 *
 * Returns what did not come, and why the last of it was refused; null where all did.
 */
export async function bringLeft(
  drawn: { readonly first: number; slots: Slot[] },
  left: Standing,
  changed: Changed,
): Promise<Omit<LostChanges, "name"> | null> {
  const givenUp = new Set<Blockly.BlockSvg>();
  const wanted: Standing = {
    ...left,
    says: (block) => (givenUp.has(block) ? { missing: "refused" } : left.says(block)),
    isDropped: (block) => !givenUp.has(block) && left.isDropped(block),
  };
  let why = "";
  for (let most = Number.POSITIVE_INFINITY; ; most = 1) {
    let slots: Slot[] = [];
    let blocks: Blockly.BlockSvg[] = [];
    let refusal = "";
    await changed(
      (document) => {
        slots = drawn.slots.map((slot) => ({ ...slot }));
        const steps = stepsOf(document, drawn.first, slots, wanted, most);
        blocks = steps.map(({ block }) => block);
        return steps.map(({ edit }) => edit);
      },
      (said) => (refusal = said),
    );
    if (refusal === "") drawn.slots = slots;
    else why = refusal;
    if (blocks.length === 0 || (refusal === "" && most > 1)) break;
    if (refusal !== "" && most === 1) for (const block of blocks) givenUp.add(block);
  }
  const changes = unsaid(drawn.slots, left);
  return changes.length > 0 ? { changes, why } : null;
}

/** What blocks say and the text does not, in a few words each. */
function unsaid(slots: readonly Slot[], { order, says }: Standing): string[] {
  const prints = new Map(slots.map(({ block, print }) => [block, print]));
  return [...new Set([...slots.map(({ block }) => block), ...order])].flatMap((block) => {
    const said = says(block);
    if (said !== null && "missing" in said) return [];
    const print = prints.get(block);
    if (said === null) return print === undefined ? [] : ["a block that was deleted"];
    return fingerprint(said) === print ? [] : [statementTitle(said)];
  });
}
