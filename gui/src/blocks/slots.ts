// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Edit, PlacedCollection, RuleDocument, Statement } from "../api/types";
import { edited } from "./edited";
import { fingerprint, toStatement } from "./model";

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
export interface Placed {
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

/** The edits, one after the other, that bring the text to what the blocks say; as `nextEdit` for each. */
export function editsOf(document: RuleDocument, first: number, slots: Slot[], tops: Blockly.BlockSvg[]): Edit[] {
  const edits: Edit[] = [];
  let collections = document.collections;
  for (;;) {
    const edit = nextEdit(collections, first, slots, tops);
    if (edit === null) return edits;
    edits.push(edit);
    collections = edited(collections, edit);
  }
}

/**
 * The next edit that brings the text to what the blocks say; null when they agree, or when the text is
 * no longer the one that the slots know.
 *
 * `first` is the number of the first slot's statement. `slots` is in the order of the text and is changed as if the edit were done.
 */
function nextEdit(
  collections: PlacedCollection[],
  first: number,
  slots: Slot[],
  tops: Blockly.BlockSvg[],
): Edit | null {
  const places = placedIn(collections).slice(first, first + slots.length);
  const isKnown = slots.every((slot, index) => slot.print === printAt(places, index));
  if (places.length !== slots.length || !isKnown) return null;
  slots.forEach((slot, index) => {
    slot.id = places[index]?.statement.id ?? "";
  });
  return (
    nextDelete(slots) ??
    nextReplace(slots) ??
    nextInsert(collections[0], places, slots, tops) ??
    nextMove(places, slots, tops)
  );
}

function printAt(places: Placed[], index: number): string | null {
  const place = places[index];
  return place ? fingerprint(place.statement) : null;
}

function nextDelete(slots: Slot[]): Edit | null {
  const index = slots.findIndex((slot) => slot.block.isDisposed() || !isTop(slot.block));
  const [slot] = index < 0 ? [] : slots.splice(index, 1);
  return slot ? { kind: "delete", id: slot.id } : null;
}

function nextReplace(slots: Slot[]): Edit | null {
  for (const slot of slots) {
    if (slot.block.type === "adirf_raw") continue;
    const statement = toStatement(slot.block);
    if ("missing" in statement) continue;
    const print = fingerprint(statement);
    if (print === slot.print) continue;
    slot.print = print;
    const comments = statement.comments?.join("\n") ?? null;
    const known = comments === slot.comments;
    slot.comments = comments;
    return {
      kind: "replace",
      id: slot.id,
      statement: { ...statement, comments: known ? null : (statement.comments ?? []) },
    };
  }
  return null;
}

function nextInsert(
  fallback: PlacedCollection | undefined,
  places: Placed[],
  slots: Slot[],
  tops: Blockly.BlockSvg[],
): Edit | null {
  const known = new Set<Blockly.Block>(slots.map((slot) => slot.block));
  for (const block of tops) {
    if (known.has(block)) continue;
    const statement = toStatement(block);
    if ("missing" in statement) continue;
    const at = insertionIndex(slots, block);
    const target = collectionAt(places, at, fallback);
    if (target === null) continue;
    slots.splice(at, 0, newSlot(block, statement));
    return { kind: "insert", collection: target.id, index: target.index, statement };
  }
  return null;
}

/** After the block above it; else defaults and floors before the first rule, rules at the end. */
function insertionIndex(slots: Slot[], block: Blockly.Block): number {
  const above = slots.findIndex((slot) => slot.block === block.getPreviousBlock());
  if (above >= 0) return above + 1;
  const below = slots.findIndex((slot) => slot.block === block.getNextBlock());
  if (below >= 0) return below;
  const rule = slots.findIndex((slot) => slot.block.type === "adirf_rule");
  return block.type === "adirf_rule" || rule < 0 ? slots.length : rule;
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

function nextMove(places: Placed[], slots: Slot[], tops: Blockly.BlockSvg[]): Edit | null {
  for (const block of tops) {
    const above = slots.findIndex((slot) => slot.block === block.getPreviousBlock());
    const here = slots.findIndex((slot) => slot.block === block);
    const target = places[above];
    if (above < 0 || here < 0 || here > above || !target) continue;
    const [slot] = slots.splice(here, 1);
    if (!slot) continue;
    slots.splice(above, 0, slot);
    const same = places[here]?.collection === target.collection;
    return { kind: "move", id: slot.id, collection: target.collection.id, index: target.index + (same ? 0 : 1) };
  }
  return null;
}

/** Whether a block is a statement of its own: not inside another block. */
export function isTop(block: Blockly.Block): boolean {
  return block.getSurroundParent() === null;
}

/** All blocks that are statements of their own, or could become some. */
export function topsIn(workspace: Blockly.WorkspaceSvg): Blockly.BlockSvg[] {
  return workspace.getTopBlocks(true).flatMap((top) => {
    const chain: Blockly.BlockSvg[] = [];
    for (let block: Blockly.BlockSvg | null = top; block; block = block.getNextBlock()) {
      if (!block.isInsertionMarker()) chain.push(block);
    }
    return chain;
  });
}

/** What the block of a slot says now, null where that is nothing that a text could say. */
export function saidBy({ block }: Slot): string | null {
  if (block.isDisposed() || !isTop(block) || block.type === "adirf_raw") return null;
  const said = toStatement(block);
  return "missing" in said ? null : fingerprint(said);
}
