// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import * as english from "blockly/msg/en";
import type { Statement } from "../api/types";
import { isNarrow } from "../ui/watch";
import { addBound, addCheck, addRate, addRecord, toggleElse } from "./block_buttons";
import { type BlockButtons, defineBlocks } from "./block_types";
import type { Suggestions } from "./fields";
import { scrollByFinger } from "./finger";
import { type MenuPage, useOwnMenus } from "./menus";
import { blocklyTheme } from "./palette";
import { addAnotherOnShiftEnter, useOwnKeys } from "./shortcuts";
import { offerRecipes, toolbox } from "./toolbox";

const SCALE = 0.72;
const SCALE_FOR_FINGERS = 0.95;

/** A workspace of Blockly that knows the blocks of rules; `act` and `toggleFold` are called by the buttons of a whole rule. */
export function newWorkspace(
  host: HTMLElement,
  suggestions: Suggestions,
  recipes: () => Promise<readonly Statement[] | null>,
  { act, toggleFold }: Pick<BlockButtons, "act" | "toggleFold">,
  page: MenuPage,
): Blockly.WorkspaceSvg {
  Blockly.setLocale(english as unknown as Record<string, string>);
  const buttons: BlockButtons = {
    addCheck: (block) => addCheck(block, suggestions),
    addRate: (block, input) => addRate(block, input, suggestions.topics()),
    addBound: (block, input) => addBound(block, input, suggestions),
    addRecord,
    toggleElse: (block) => toggleElse(block, suggestions.topics()),
    remove: (block) => block.checkAndDelete(),
    toggleFold,
    act,
  };
  defineBlocks(suggestions, buttons);
  addAnotherOnShiftEnter(buttons, page.newRate);
  const isBelow = isNarrow();
  // Else each block measures its texts anew, for which the browser computes styles each time.
  Blockly.utils.dom.startTextWidthCache();
  const workspace = silently(() =>
    Blockly.inject(host, {
      // A question of the browser's own would have no list to pick from.
      modalInputs: false,
      renderer: "zelos",
      theme: blocklyTheme(host),
      toolbox: toolbox(),
      // Beside the blocks it would leave them no room.
      horizontalLayout: isBelow,
      media: "./media/",
      trashcan: false,
      // A rule is switched off in the text.
      disable: false,
      sounds: false,
      zoom: {
        controls: !isBelow,
        wheel: false,
        pinch: true,
        startScale: matchMedia("(pointer: coarse)").matches ? SCALE_FOR_FINGERS : SCALE,
        minScale: 0.3,
        maxScale: 2,
      },
      move: { scrollbars: true, drag: true, wheel: true },
    }),
  );
  offerRecipes(workspace, recipes);
  useOwnMenus(workspace, buttons, page);
  useOwnKeys(host);
  scrollByFinger(host);
  // The text keeps what is undone.
  workspace.MAX_UNDO = 0;
  keepFocus(host);
  return workspace;
}

/** Lets nobody edit blocks, or everybody; Blockly says of a field which it is only while it draws the block. */
export function setReadOnly(workspace: Blockly.WorkspaceSvg, readOnly: boolean): void {
  if (readOnly === workspace.isReadOnly()) return;
  workspace.setIsReadOnly(readOnly);
  for (const field of workspace.getAllBlocks(false).flatMap((block) => [...block.getFields()])) {
    field.updateEditable();
    // It would call a plain word a button.
    if (!(field instanceof Blockly.FieldLabel)) field.recomputeAriaContext();
  }
}

/** Blockly opens an audio context for each workspace, even for one without sounds. */
function silently<T>(work: () => T): T {
  const { AudioContext } = window;
  Object.assign(window, { AudioContext: undefined });
  try {
    return work();
  } finally {
    Object.assign(window, { AudioContext });
  }
}

/**
 * Keeps the focus where two keys lead within a frame: Blockly 13.3 brings a focused block to the front a frame later by
 * moving those behind it, which takes the focus from one that got it meanwhile.
 */
function keepFocus(host: HTMLElement): void {
  let focused: EventTarget | null = null;
  host.addEventListener("focusin", ({ target }) => {
    focused = target;
    requestAnimationFrame(() => {
      const isLost = document.activeElement === document.body;
      if (isLost && focused instanceof SVGElement && focused.isConnected) focused.focus({ preventScroll: true });
    });
  });
}
