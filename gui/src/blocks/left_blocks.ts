// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Lost } from "../state/work_ahead";
import { fingerprint } from "./model";
import { statementTitle } from "./rule_words";
import { type Changed, type Slot, type Standing, stepsOf } from "./slots";

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
): Promise<Omit<Lost, "name"> | null> {
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
