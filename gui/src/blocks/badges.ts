// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Action, CheckCondition, PlacedFinding, Statement, Truth } from "../api/types";
import { checksOf } from "../state/statements";
import { readable, valueText } from "../ui/numbers";
import { ACTION_TYPES } from "./action_model";
import type { CheckState, RuleState, TimeState } from "./live_states";
import { FOLDED, stacked, type TimePart, timesOn } from "./model";
import type { Slot } from "./slots";

const GAP = 10;
const HEIGHT = 32;
const FIRST_ROW = 48;
// Letters are drawn in a monospaced font, so that no badge needs to be measured.
const LETTER_WIDTH = 10.9;
const PADDING = 9;

type UnitOf = (check: Blockly.Block) => string;

/** What a badge says, and in which colour. */
interface Badge {
  look: Truth;
  words: string;
}
interface Drawn extends Badge {
  group: SVGGElement;
  box: SVGRectElement;
  text: SVGTextElement;
  /** The size of the block that the badge stands beside. */
  size: string;
}

/** Small signs beside blocks: whether a condition holds on the robot now. Blocks are not drawn anew for them. */
export class Badges {
  private readonly drawn = new Map<Blockly.BlockSvg, Drawn>();

  /** Shows exactly the `states`, by rule block, and touches only what differs from before. */
  show(states: ReadonlyMap<Blockly.BlockSvg, RuleState>, unitOf: UnitOf): void {
    const wanted = new Map<Blockly.BlockSvg, Badge>();
    for (const [rule, state] of states) {
      // A folded rule has no checks to stand beside.
      const badges = rule.type === FOLDED ? new Map() : conditionBadges(rule, state, unitOf);
      if (badges === null) continue;
      wanted.set(rule, { look: state.state, words: RULE_WORDS[state.state] });
      for (const [block, badge] of badges) wanted.set(block, badge);
    }
    for (const [block, { group }] of this.drawn) {
      if (wanted.has(block)) continue;
      group.remove();
      this.drawn.delete(block);
    }
    for (const [block, badge] of wanted) this.draw(block, badge);
  }

  private draw(block: Blockly.BlockSvg, badge: Badge): void {
    const drawn = this.drawn.get(block) ?? this.create(block);
    const size = `${block.width} ${block.height}`;
    if (drawn.size !== size) {
      const { width } = (block.pathObject.svgPath as SVGPathElement).getBBox();
      const y = Math.min(block.height, FIRST_ROW) / 2;
      drawn.group.setAttribute("transform", `translate(${width + GAP}, ${y})`);
      drawn.size = size;
    }
    if (drawn.words === badge.words) return;
    drawn.words = badge.words;
    drawn.text.textContent = badge.words;
    drawn.box.setAttribute("width", String(badge.words.length * LETTER_WIDTH + 2 * PADDING));
    drawn.group.setAttribute("class", `badge ${badge.look}`);
    drawn.group.setAttribute("aria-label", `On the robot: ${badge.words}`);
  }

  private create(block: Blockly.BlockSvg): Drawn {
    const { createSvgElement } = Blockly.utils.dom;
    const group = createSvgElement(Blockly.utils.Svg.G, { role: "img" }, block.getSvgRoot());
    const box = createSvgElement(Blockly.utils.Svg.RECT, { y: -HEIGHT / 2, height: HEIGHT, rx: HEIGHT / 2 }, group);
    const text = createSvgElement(Blockly.utils.Svg.TEXT, { x: PADDING, dy: "0.35em" }, group);
    const drawn: Drawn = { group, box, text, size: "", look: "unknown", words: "" };
    this.drawn.set(block, drawn);
    return drawn;
  }
}

/** The badges of a rule's condition; null where its blocks are not those that the robot tells of. */
function conditionBadges(rule: Blockly.Block, state: RuleState, unitOf: UnitOf): Map<Blockly.BlockSvg, Badge> | null {
  const badges = new Map<Blockly.BlockSvg, Badge>();
  // Both are in the order of the text, in which a time ends behind what it is about.
  const [checks, times] = [[...state.checks], [...state.times]];
  let isKnown = true;
  const visit = (block: Blockly.Block) => {
    const said: Badge[] = [];
    if (block.type === "adirf_check") {
      const check = checks.shift();
      isKnown &&= check !== undefined;
      if (check) said.push({ look: check.state, words: checkWords(check, unitOf(block)) });
    } else stacked(block, "TERMS").forEach(visit);
    for (const part of timesOn(block)) {
      const time = times.shift();
      if (time) said.push({ look: time.state, words: timeWords(time, part) });
    }
    const last = said.at(-1);
    if (last)
      badges.set(block as Blockly.BlockSvg, { look: last.look, words: said.map(({ words }) => words).join(" · ") });
  };
  stacked(rule, "IF").forEach(visit);
  return isKnown && checks.length === 0 ? badges : null;
}

const CHECK_WORDS = { true: "✓ true", false: "✗ false", unknown: "? unknown" };
const RULE_WORDS = { true: "✓ holds", false: "✗ does not hold", unknown: "? unknown" };
const SIGNS: Record<Truth, string> = { true: "✓", false: "✗", unknown: "?" };
const IN_MS_BELOW_S = 1;
const IN_MIN_FROM_S = 120;

/** What a badge says of a check, with the value that it reads. */
export function checkWords({ state, value }: CheckState, unit: string): string {
  const shown = value === null ? "" : ` ${valueText(value)}${unit && ` ${unit}`}`;
  return `${CHECK_WORDS[state]}${shown}`;
}

/** What a badge says of a time: how much of it is over, as in `holds for 6 s of 10 s`. */
export function timeWords({ state, held_s }: TimeState, { word, duration }: TimePart): string {
  const whole = `${duration.value} ${duration.unit}`;
  if (held_s === null) return `${SIGNS[state]} not known for ${whole} yet`;
  if (word === "For") {
    if (held_s === 0) return `${SIGNS[state]} does not hold now`;
    return `${SIGNS[state]} holds for ${spell(held_s)}${state === "true" ? "" : ` of ${whole}`}`;
  }
  if (held_s === 0) return `${SIGNS[state]} holds now`;
  if (state === "true") return `${SIGNS[state]} held ${spell(held_s)} ago`;
  return state === "false" ? `${SIGNS[state]} not in the last ${whole}` : `${SIGNS[state]} not for ${spell(held_s)}`;
}

function spell(seconds: number): string {
  if (seconds < IN_MS_BELOW_S) return `${Math.round(seconds * 1000)} ms`;
  if (seconds < IN_MIN_FROM_S) return `${Math.floor(seconds)} s`;
  return `${readable(Math.floor(seconds / 60))} min`;
}

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

/** Takes the mark off a block, which gets the focus if the mark had it. */
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
