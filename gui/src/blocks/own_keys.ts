// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { isTyped, openField } from "./open_field";

const { registry } = Blockly.ShortcutRegistry;
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
