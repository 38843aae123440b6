// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { BlockButtons } from "./block_types";

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
