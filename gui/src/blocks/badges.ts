// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Truth } from "../api/types";
import { readable, valueText } from "../ui/numbers";
import type { CheckState, RuleState, TimeState } from "./live_states";
import { checksOn, FOLDED, stacked, type TimePart, timesOn } from "./model";

const GAP = 10;
const HEIGHT = 32;
const FIRST_ROW = 48;
// Letters are drawn in a monospaced font, so that no badge needs to be measured.
const LETTER_WIDTH = 10.9;
const PADDING = 9;

type UnitOf = (check: Blockly.Block) => string;

/** What a badge says, and in which colour. */
interface Badge {
  look: Truth | "other";
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

  /** Shows exactly the `states`, by rule block, and which differ from the robot's; touches only what differs from before. */
  show(states: ReadonlyMap<Blockly.BlockSvg, RuleState>, differing: readonly Blockly.BlockSvg[], unitOf: UnitOf): void {
    const wanted = new Map<Blockly.BlockSvg, Badge>(
      differing.map((block) => [block, { look: "other", words: DIFFERS }]),
    );
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
    const count = checksOn(block);
    if (count > 0) {
      const own = checks.splice(0, count);
      isKnown &&= own.length === count;
      const [first] = own;
      const state = allOf(own);
      if (first && count === 1) said.push({ look: state, words: checkWords(first, unitOf(block)) });
      else if (first) said.push({ look: state, words: CHECK_WORDS[state] });
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

/** Whether all of some checks hold. */
function allOf(checks: readonly CheckState[]): Truth {
  const has = (state: Truth) => checks.some((each) => each.state === state);
  return has("false") ? "false" : has("unknown") ? "unknown" : "true";
}

const CHECK_WORDS = { true: "✓ true", false: "✗ false", unknown: "? unknown" };
const RULE_WORDS = { true: "✓ holds", false: "✗ does not hold", unknown: "? unknown" };
const DIFFERS = "● differs from the robot";
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
