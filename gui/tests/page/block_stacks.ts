// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { EditorView } from "@codemirror/view";
import { expect } from "vitest";

const CANVAS = ".blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas";
const STATEMENTS = /(?:SetFrequency|KeepAtLeast|KeepWithin) (\S+)|\bIf\b[^/]*(\S+)/g;

/** Blocks that hang together: their extent on the screen, and the first topic of each statement. */
export interface Stack {
  top: number;
  bottom: number;
  left: number;
  /** A rule that lacks a part says `?`: the text has what it said before. A check alone says nothing. */
  says: string[];
}

/** What stands on the canvas of the blocks now, from above. */
export function stacks(): Stack[] {
  return fromAbove(document.querySelectorAll(`${CANVAS} > .blocklyDraggable`))
    .map(stackOf)
    .sort(byTop);
}

export function gaps(all: readonly Stack[] = stacks()): number[] {
  return all.slice(1).map((stack, index) => stack.top - (all[index] as Stack).bottom);
}

/** The blocks say what the text says, in its order, with the same gaps. */
export async function expectOrder(): Promise<void> {
  await expect.poll(problem).toBe("");
}

/** The editor of the text. */
export function textView(): EditorView {
  const view = EditorView.findFromDOM(document.querySelector(".cm-editor") as HTMLElement);
  if (view === null) throw new Error("there is no text");
  return view;
}

function problem(): string {
  const all = stacks();
  const [blocks, text] = [all.flatMap(({ says }) => says), said()];
  const isSame = blocks.length === text.length && blocks.every((each, index) => each === "?" || each === text[index]);
  if (!isSame) return `the blocks say ${blocks}, the text ${text}`;
  const between = gaps(all);
  const isEven = between.every((gap) => gap > 4 && Math.abs(gap - (between[0] ?? 0)) < 1);
  if (!isEven) return `the gaps are ${between}`;
  const lefts = all.map(({ left }) => left);
  return lefts.every((left) => Math.abs(left - (lefts[0] ?? 0)) < 1) ? "" : `the left ends are ${lefts}`;
}

/** The first topic of each statement of the text. */
function said(): (string | undefined)[] {
  const outside = textView()
    .state.doc.toString()
    .replace(/\bThen\b[\s\S]*?EndIf/g, "");
  return [...outside.matchAll(STATEMENTS)].map(([, byDefault, check]) => byDefault ?? check);
}

function stackOf(root: Element): Stack {
  const blocks = [root, ...root.querySelectorAll(".blocklyDraggable")];
  const boxes = blocks.map((block) => edgeOf(block.querySelector(":scope > .blocklyPath") ?? block));
  const isRule = root.matches(".adirf_rule, .adirf_folded");
  const isDefault = root.matches(".adirf_set, .adirf_within, .adirf_keep");
  return {
    top: Math.min(...boxes.map(({ top }) => top)),
    bottom: Math.max(...boxes.map(({ bottom }) => bottom)),
    left: Math.min(...boxes.map(({ left }) => left)),
    says: isRule ? [ruleOf(root)] : isDefault ? topicsOf(root, "") : [],
  };
}

function ruleOf(root: Element): string {
  if (root.matches(".adirf_folded")) return /if\s(\S+)/.exec(root.textContent ?? "")?.[1] ?? "?";
  const actions = root.querySelectorAll(".adirf_set, .adirf_within, .adirf_record").length;
  const hasElse = root.querySelector('[aria-label="Remove ELSE"]') !== null;
  return (actions > (hasElse ? 1 : 0) && topicsOf(root, "check")[0]) || "?";
}

function topicsOf(part: Element, use: string): string[] {
  const fields = fromAbove(part.querySelectorAll(`[aria-label^="Edit topic to ${use}"]`));
  return fields.map((field) => field.getAttribute("aria-label")?.split(": ")[1] ?? "?");
}

/** Blockly moves what has the focus to the front, which is the end of the document. */
function fromAbove(found: Iterable<Element>): Element[] {
  return [...found].sort((one, other) => byTop(edgeOf(one), edgeOf(other)));
}

function byTop(one: { top: number }, other: { top: number }): number {
  return one.top - other.top;
}

function edgeOf(element: Element): DOMRect {
  return element.getBoundingClientRect();
}
