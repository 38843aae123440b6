// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { BlockButtons, RuleAct } from "./block_types";
import { type Choice, timeChoices } from "./clocks";
import { FOLDED, type RuleBlock } from "./model";
import { NEW_STATEMENTS, type NewStatement } from "./rule_words";
import { INSIDE } from "./zones";

type Block = Blockly.BlockSvg;

/** What the menus change beside blocks. */
export interface MenuPage {
  undo(): void;
  redo(): void;
  canUndo(): boolean;
  canRedo(): boolean;
  addStatement(kind: NewStatement): void;
  foldAll(isFolded: boolean): void;
}

const CONDITIONS = new Set(["adirf_check", "adirf_all", "adirf_any", "adirf_not", INSIDE]);
const STATEMENTS = new Set(["adirf_set", "adirf_within", "adirf_keep", "adirf_rule", FOLDED]);
const WORDS: Readonly<Record<string, string>> = {
  adirf_rule: "rule",
  [FOLDED]: "rule",
  adirf_set: "rate",
  adirf_within: "bound",
  adirf_keep: "floor",
  adirf_record: "recording",
  adirf_parameter: "action",
  adirf_call: "action",
  adirf_notify: "action",
  adirf_check: "check",
  [INSIDE]: "zone",
  adirf_all: "all of",
  adirf_any: "any of",
  adirf_not: "not",
};

/** Gives blocks and the ground between them menus of our own, in the place of Blockly's. */
export function useOwnMenus(workspace: Blockly.WorkspaceSvg, buttons: BlockButtons, page: MenuPage): void {
  Blockly.ContextMenuRegistry.registry.reset();
  workspace.configureContextMenu = (options) => {
    const isOff = workspace.isReadOnly();
    const own = [
      ...Object.entries(NEW_STATEMENTS).map(([kind, text]) => ({
        text,
        enabled: !isOff,
        callback: () => page.addStatement(kind as NewStatement),
      })),
      { text: "Fold all", enabled: true, callback: () => page.foldAll(true) },
      { text: "Unfold all", enabled: true, callback: () => page.foldAll(false) },
      ...pageChoices(page),
    ];
    options.splice(0, options.length, ...(own as unknown as typeof options));
  };
  workspace.addChangeListener((event) => {
    if (event instanceof Blockly.Events.BubbleOpen && !event.isOpen) dropEmptyComment(workspace, event.blockId);
  });
  for (const definition of Object.values(Blockly.Blocks)) {
    Object.assign(definition, {
      customContextMenu(this: Block, options: object[]) {
        if (!this.isInFlyout) options.splice(0, options.length, ...blockChoices(this, buttons), ...pageChoices(page));
      },
    });
  }
}

function pageChoices(page: MenuPage): Choice[] {
  return [
    { text: "Undo", enabled: page.canUndo(), callback: () => page.undo() },
    { text: "Redo", enabled: page.canRedo(), callback: () => page.redo() },
  ];
}

function blockChoices(block: Block, buttons: BlockButtons): Choice[] {
  const isOff = block.workspace.isReadOnly();
  const isStatement = STATEMENTS.has(block.type) && block.getSurroundParent() === null;
  const word = WORDS[block.type];
  const choices = [
    ...(CONDITIONS.has(block.type) ? timeChoices(block) : []),
    ...(WORDS[block.type] === "rule" ? ruleChoices(block as RuleBlock, buttons) : []),
    ...(isStatement ? commentChoices(block) : []),
    ...(word ? [{ text: `Remove this ${word}`, enabled: true, callback: () => buttons.remove(block) }] : []),
  ];
  return choices.map((choice) => ({ ...choice, enabled: choice.enabled && !isOff }));
}

function ruleChoices(rule: RuleBlock, buttons: BlockButtons): Choice[] {
  const choice = (text: string, act: RuleAct) => ({ text, enabled: true, callback: () => buttons.act(rule, act) });
  return [
    {
      text: rule.type === FOLDED ? "Unfold this rule" : "Fold this rule",
      enabled: true,
      callback: () => buttons.toggleFold(rule),
    },
    choice(rule.isSwitchedOff() ? "Switch this rule on" : "Switch this rule off", "switch"),
    choice("Duplicate this rule", "duplicate"),
    choice("Move this rule up", "up"),
    choice("Move this rule down", "down"),
  ];
}

function commentChoices(block: Block): Choice[] {
  const hasSome = block.getCommentText() !== null;
  const choices = [
    { text: hasSome ? "Edit the comment" : "Add a comment", enabled: true, callback: () => void openComment(block) },
  ];
  if (hasSome)
    choices.push({ text: "Remove the comment", enabled: true, callback: () => void block.setCommentText(null) });
  return choices;
}

/** Opens the comment of a block to type into; one that stays empty goes again. */
async function openComment(block: Block): Promise<void> {
  if (block.getCommentText() === null) block.setCommentText("");
  const icon = block.getIcon(Blockly.icons.CommentIcon.TYPE) as Blockly.icons.CommentIcon | null;
  await icon?.setBubbleVisible(true);
  icon?.getBubble()?.performAction();
}

function dropEmptyComment(workspace: Blockly.WorkspaceSvg, id: string | undefined): void {
  const block = id === undefined ? null : workspace.getBlockById(id);
  if (block?.getCommentText()?.trim() === "") block.setCommentText(null);
}
