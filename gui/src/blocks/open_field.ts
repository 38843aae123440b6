// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";

/**
 * Does what a key means in every field that somebody types into; whether the field has nothing more to do with it.
 *
 * Enter and Tab end nothing while the text is refused. Tab goes on to the next field. Shift+Enter is a key of the
 * workspace, which Blockly keeps from open fields.
 */
export function takeKey(field: Blockly.Field, event: KeyboardEvent, isRefused: boolean): boolean {
  if (event.key !== "Tab" && event.key !== "Enter") return false;
  const isPlainEnter = event.key === "Enter" && !event.shiftKey;
  if (isPlainEnter && !isRefused) return false;
  event.preventDefault();
  event.stopPropagation();
  if (isRefused) return true;
  const { workspace } = field.getSourceBlock() as Blockly.BlockSvg;
  if (event.key === "Tab") openNext(field, event.shiftKey);
  else Blockly.ShortcutRegistry.registry.onKeyDown(workspace, event);
  return true;
}

/** Closes an open field and opens the next one of the rule, or the one before; at the end it only closes. */
export function openNext(field: Blockly.Field, isBackwards: boolean): void {
  const fields = typedFields(field.getSourceBlock()?.getRootBlock() ?? null);
  const next = fields[fields.indexOf(field) + (isBackwards ? -1 : 1)];
  Blockly.WidgetDiv.hideIfOwner(field);
  Blockly.DropDownDiv.hideIfOwner(field, true);
  openField(next ?? null);
}

const MARGIN = 24;

/** A field that can be opened without a list that covers what is below it. */
export interface QuietField {
  openQuietly(): void;
}

/** Scrolls up or down to a block; a block that is wider than the view begins at its left edge. */
export function scrollToBlock(block: Blockly.BlockSvg): void {
  const { top, bottom, left, right } = block.getBoundingRectangleWithoutChildren();
  const { width } = block.workspace.getMetricsManager().getViewMetrics(true);
  const begin = new Blockly.utils.Rect(top, bottom, left, Math.min(right, left + width - 2 * MARGIN));
  block.workspace.scrollBoundsIntoView(begin, MARGIN);
}

/** Puts the focus on a field that is in sight then, and opens it to type into. */
export function openField(field: Blockly.Field | null): void {
  if (field === null) return;
  const block = field.getSourceBlock();
  if (block instanceof Blockly.BlockSvg) {
    Blockly.renderManagement.triggerQueuedRenders(block.workspace);
    scrollToBlock(block);
  }
  Blockly.getFocusManager().focusNode(field);
  if ("openQuietly" in field) (field as unknown as QuietField).openQuietly();
  else field.showEditor();
}

/** Closes the open field as Enter does: with its text, and not where that is refused. */
export function closeField(): void {
  openInput()?.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter" }));
}

/** Whether the open field has another text than when it opened, or a menu is open. */
export function isTyping(): boolean {
  const input = openInput();
  return Blockly.WidgetDiv.isVisible() && (!input || input.value !== input.defaultValue);
}

/** Whether somebody went on with another part of the page, such as the list of blocks or the text. */
export function isElsewhere(workspace: Blockly.WorkspaceSvg): boolean {
  const { activeElement } = document;
  return activeElement !== document.body && !workspace.getParentSvg().contains(activeElement);
}

function openInput(): HTMLInputElement | null {
  return Blockly.WidgetDiv.getDiv()?.querySelector("input") ?? null;
}

/** Whether somebody types into a field. */
export function isTyped(field: object | null): field is Blockly.FieldTextInput | Blockly.FieldNumber {
  return [Blockly.FieldTextInput, Blockly.FieldNumber].some((type) => field instanceof type);
}

/** The fields of a block and of those in it that somebody types into or chooses in, in the order in which they are read. */
function typedFields(block: Blockly.Block | null): Blockly.Field[] {
  const all = block?.getDescendants(true).flatMap(({ inputList }) => inputList.flatMap(({ fieldRow }) => fieldRow));
  return (all ?? []).filter((field) => isTyped(field) || field instanceof Blockly.FieldDropdown);
}
