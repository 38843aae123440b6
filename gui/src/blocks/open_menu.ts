// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";

/** A line of a menu. */
export interface Choice {
  text: string;
  enabled: boolean;
  callback: () => void;
}

/** Opens a menu below a place of the page; Enter takes its first line. */
export function openMenu(
  choices: readonly Choice[],
  workspace: Blockly.WorkspaceSvg,
  below: DOMRect | undefined,
): void {
  const place = new Blockly.utils.Coordinate(below?.left ?? 0, below?.bottom ?? 0);
  Blockly.ContextMenu.show(new Event("click"), [...choices], false, workspace, place);
  const menu = Blockly.ContextMenu.getMenu();
  menu?.setHighlighted(null);
  menu?.highlightNext();
}
