// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { BlockButtons } from "./block_types";
import { isTyped, openField } from "./open_field";

const { registry } = Blockly.ShortcutRegistry;
const NAME = "add_another";

/** Lets Shift+Enter add one more of what has the focus, below it: a check, a rate, a bound, a recording or a default. */
export function addAnotherOnShiftEnter(buttons: BlockButtons, addDefault: () => void): void {
  const { KeyCodes } = Blockly.utils;
  const callback = () => {
    const node = Blockly.getFocusManager().getFocusedNode();
    const block = node instanceof Blockly.Field ? node.getSourceBlock() : node;
    if (!(block instanceof Blockly.BlockSvg)) return false;
    const parent = block.getSurroundParent();
    if (parent === null && block.type !== "adirf_set") return false;
    Blockly.WidgetDiv.hideIfOwner(node);
    if (parent === null) addDefault();
    else addBeside(block, parent, buttons);
    return true;
  };
  const keyCodes = [registry.createSerializedKey(KeyCodes.ENTER, [KeyCodes.SHIFT])];
  // The page opened other rules before, whose buttons are gone.
  if (NAME in registry.getRegistry()) registry.unregister(NAME);
  registry.register({ name: NAME, callback, keyCodes, preconditionFn: (space) => !space.isReadOnly() });
}

function addBeside(block: Blockly.BlockSvg, parent: Blockly.BlockSvg, buttons: BlockButtons): void {
  const holds = (name: string) => parent.getInputTargetBlock(name)?.getDescendants(false).includes(block);
  const part = holds("ELSE") ? "ELSE" : "THEN";
  if (block.type === "adirf_set") buttons.addRate(parent, part);
  else if (block.type === "adirf_within") buttons.addBound(parent, part);
  else if (block.type === "adirf_record") buttons.addRecord(parent, part);
  else buttons.addCheck(parent);
}

/** What the column of blocks and our own buttons do. */
const SUPERFLUOUS = ["cleanup", "duplicate"];

/** Lets a letter on a field that has the focus open it, as in a table: it is no shortcut there. */
export function useOwnKeys(host: HTMLElement): void {
  for (const name of SUPERFLUOUS) if (name in registry.getRegistry()) registry.unregister(name);
  const open = (event: KeyboardEvent) => {
    const field = Blockly.getFocusManager().getFocusedNode();
    const isLetter = event.key.length === 1 && event.key !== " " && !event.ctrlKey && !event.metaKey && !event.altKey;
    if (!isLetter || !isTyped(field) || Blockly.WidgetDiv.isVisible()) return;
    const block = field.getSourceBlock();
    if (!(block instanceof Blockly.BlockSvg) || block.workspace.isReadOnly() || !block.isEditable()) return;
    event.stopPropagation();
    // The letter itself goes into the field, in the place of what is marked there.
    openField(field);
  };
  host.addEventListener("keydown", open, { capture: true });
}
