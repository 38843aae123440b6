// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Action, CheckCondition, PlacedFinding, Statement } from "../api/types";
import { ACTION_TYPES } from "./actions";
import { checksOf } from "./live_states";
import type { Slot } from "./slots";

/** The marks on blocks; a block is touched only where its mark changes. */
export class Warnings {
  private shown = new Map<Blockly.BlockSvg, string>();

  /** Shows what findings say on the very blocks that they are about, and `missing` on those that say nothing yet. */
  show(
    slots: readonly Slot[],
    statements: readonly Statement[],
    findings: readonly PlacedFinding[],
    missing: ReadonlyMap<Blockly.BlockSvg, string>,
  ): void {
    const next = new Map<Blockly.BlockSvg, string>();
    const add = (block: Blockly.BlockSvg, text: string) => {
      const before = next.get(block);
      next.set(block, before === undefined ? text : `${before}\n\n${text}`);
    };
    const numbers = new Map(slots.map((slot, index) => [slot.id, index]));
    for (const finding of findings) {
      const text = finding.hint ? `${finding.message}\n${finding.hint}` : finding.message;
      for (const id of [finding.statement, ...finding.related]) {
        const index = numbers.get(id ?? "");
        const [slot, statement] = index === undefined ? [] : [slots[index], statements[index]];
        if (!slot || !statement || slot.block.isDisposed()) continue;
        add(id === finding.statement ? blockAt(slot.block, statement, finding) : slot.block, text);
      }
    }
    for (const [block, text] of missing) add(block, text);
    this.replace(next);
  }

  private replace(next: Map<Blockly.BlockSvg, string>): void {
    for (const block of this.shown.keys()) {
      if (!next.has(block) && !block.isDisposed()) take(block);
    }
    for (const [block, text] of next) {
      if (this.shown.get(block) !== text) block.setWarningText(text);
    }
    this.shown = next;
  }
}

/** Takes the mark off a block; who stands on it with the keyboard stands on the block then. */
function take(block: Blockly.BlockSvg): void {
  const focus = Blockly.getFocusManager();
  const icon = block.getIcon(Blockly.icons.WarningIcon.TYPE);
  if (icon && focus.getFocusedNode() === (icon as Blockly.icons.WarningIcon)) focus.focusNode(block);
  block.setWarningText(null);
}

/** The check, rate, bound or recording that a finding stands in, else the whole statement. */
function blockAt(block: Blockly.BlockSvg, statement: Statement, finding: PlacedFinding): Blockly.BlockSvg {
  if (statement.kind !== "rule") return block;
  const base = statement.offset ?? 0;
  const [from, to] = [finding.offset - base, finding.end_offset - base];
  const holds = (part: CheckCondition | Action) => (part.offset ?? 0) <= from && to <= (part.end_offset ?? -1);
  const inner = block.getDescendants(true) as Blockly.BlockSvg[];
  const check = checksOf(statement.condition).findIndex(holds);
  if (check >= 0) return inner.filter(({ type }) => type === "adirf_check")[check] ?? block;
  const action = [...statement.then, ...statement.else].findIndex(holds);
  return inner.filter(({ type }) => ACTION_TYPES.has(type))[action] ?? block;
}
