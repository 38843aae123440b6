// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Operator, TimeWord } from "../api/types";
import { button, choiceField, MINUS, numberField, operatorField, timeUnitField } from "./fields";
import { type ClockState, type TimePart, timeFields, timesOn } from "./model";
import type { ComparedField } from "./number_field";
import { openField } from "./open_field";

const TIME_WORDS: [string, TimeWord][] = [
  ["for", "For"],
  ["within the last", "Within"],
];
const NEW_TIME = { value: 10, unit: "s" } as const;
/** As deep as the language lets For and Within nest. */
const MOST_TIMES = 10;
const OPPOSITE: Record<Operator, Operator> = { ">": "<", "<": ">", ">=": "<", "<=": ">", "=": "!=", "!=": "=" };

/** What every block of a condition is given, so that it can have times, and a check an end. */
export const CLOCK_METHODS = {
  saveExtraState(this: Blockly.BlockSvg): ClockState | null {
    const times = timesOn(this).length;
    const hasUntil = this.getInput("UNTIL") !== null;
    return times > 0 || hasUntil ? { ...(times > 0 ? { times } : {}), ...(hasUntil ? { hasUntil } : {}) } : null;
  },
  loadExtraState(this: Blockly.BlockSvg, { times = 0, hasUntil = false }: ClockState) {
    showUntil(this, hasUntil);
    showTimes(this, times);
  },
};

/** Lets somebody choose the time to give to a condition, in a menu below the clock on its block. */
export function chooseTime(block: Blockly.BlockSvg, clock: Blockly.FieldImage): void {
  if (block.isInFlyout) return;
  openMenu(timeChoices(block), block, clock);
}

/** The times that a condition can have, and the end of a check. */
export function timeChoices(block: Blockly.BlockSvg): Choice[] {
  const enabled = timesOn(block).length < MOST_TIMES;
  const all = [
    { text: "for so long…", enabled, callback: () => addTime(block, "For") },
    { text: "within the last…", enabled, callback: () => addTime(block, "Within") },
  ];
  if (block.type !== "adirf_check") return all;
  return [...all, { text: "until…", enabled: !block.getInput("UNTIL"), callback: () => addUntil(block) }];
}

function addTime(block: Blockly.BlockSvg, word: TimeWord): void {
  const times = timesOn(block);
  change(block, () => setTimes(block, [...times, { word, duration: NEW_TIME }]));
  openField(block.getField(`LENGTH${times.length}`));
}

function addUntil(block: Blockly.BlockSvg): void {
  change(block, () => {
    showUntil(block, true);
    block.setFieldValue(OPPOSITE[block.getFieldValue("OP") as Operator], "UNTIL_OP");
    block.setFieldValue(block.getFieldValue("VALUE"), "UNTIL_VALUE");
  });
  openField(block.getField("UNTIL_VALUE"));
}

function setTimes(block: Blockly.BlockSvg, times: readonly TimePart[]): void {
  showTimes(block, times.length);
  times.forEach((part, at) => {
    for (const [name, value] of Object.entries(timeFields(part, at))) block.setFieldValue(value, name);
  });
}

/** Gives a block so many rows for times; new ones say what a new time says. */
function showTimes(block: Blockly.BlockSvg, count: number): void {
  for (let at = timesOn(block).length - 1; at >= count; at--) block.removeInput(`TIME${at}`);
  for (let at = timesOn(block).length; at < count; at++) {
    block
      .appendDummyInput(`TIME${at}`)
      .appendField(choiceField(TIME_WORDS, "time"), `WORD${at}`)
      .appendField(numberField(String(NEW_TIME.value), "duration", 0), `LENGTH${at}`)
      .appendField(timeUnitField("unit of time"), `TIME_UNIT${at}`)
      .appendField(button(MINUS, "Remove this time", () => removeTime(block, at)));
  }
}

function removeTime(block: Blockly.BlockSvg, at: number): void {
  const left = timesOn(block).filter((_, index) => index !== at);
  focus(block, "CLOCK");
  change(block, () => setTimes(block, left));
}

function showUntil(block: Blockly.BlockSvg, shown: boolean): void {
  if (shown === (block.getInput("UNTIL") !== null)) return;
  if (!shown) {
    block.removeInput("UNTIL");
    return;
  }
  block
    .appendDummyInput("UNTIL")
    .appendField("until")
    .appendField(operatorField("comparison of the end"), "UNTIL_OP")
    .appendField((block.getField("VALUE") as unknown as ComparedField).forEnd("value of the end"), "UNTIL_VALUE")
    .appendField(new Blockly.FieldLabel(""), "UNTIL_UNIT")
    .appendField(button(MINUS, "Remove this end", () => removeUntil(block)));
  if (block.getInput("TIME0")) block.moveInputBefore("UNTIL", "TIME0");
}

function removeUntil(block: Blockly.BlockSvg): void {
  focus(block, "CLOCK");
  change(block, () => showUntil(block, false));
}

/** Changes the rows of a block as one step that listeners hear of. */
export function change(block: Blockly.BlockSvg, act: () => void): void {
  Blockly.Events.setGroup(true);
  const state = () => JSON.stringify(block.saveExtraState?.() ?? null);
  const before = state();
  act();
  Blockly.Events.fire(new Blockly.Events.BlockChange(block, "mutation", null, before, state()));
  Blockly.Events.setGroup(false);
}

export function focus(block: Blockly.BlockSvg, name: string): void {
  const field = block.getField(name);
  if (field) Blockly.getFocusManager().focusNode(field);
}

/** A line of a menu. */
export interface Choice {
  text: string;
  enabled: boolean;
  callback: () => void;
}

/** Opens a menu below a button on a block; Enter takes its first line. */
export function openMenu(choices: readonly Choice[], block: Blockly.BlockSvg, button: Blockly.FieldImage): void {
  const below = button.getSvgRoot()?.getBoundingClientRect();
  const place = new Blockly.utils.Coordinate(below?.left ?? 0, below?.bottom ?? 0);
  Blockly.ContextMenu.show(new Event("click"), [...choices], false, block.workspace, place);
  const menu = Blockly.ContextMenu.getMenu();
  menu?.setHighlighted(null);
  menu?.highlightNext();
}
