// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { DurationUnit, Operator } from "../api/types";
import { NumberField } from "./number_field";
import { oneWord, type Suggestion, SuggestionField } from "./suggestion_field";

/** What the blocks suggest. */
export interface Suggestions {
  topics(): readonly string[];
  /** Topics with a word on where they come from, such as a live robot. */
  markedTopics(): readonly Suggestion[];
  /** What checks can read of a topic. */
  properties(topic: string): readonly string[];
  /** What a bound can be about, what only bounds can name first. */
  bounds(topic: string): readonly string[];
  unit(topic: string, property: string): string;
}

const OPERATORS: [string, Operator][] = [
  [">", ">"],
  ["<", "<"],
  ["≥", ">="],
  ["≤", "<="],
  ["=", "="],
  ["≠", "!="],
];
const TIME_UNITS: [string, DurationUnit][] = [
  ["s", "s"],
  ["ms", "ms"],
  ["min", "min"],
];

const icon = (path: string) =>
  `data:image/svg+xml,${encodeURIComponent(
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 24"><circle cx="12" cy="12" r="11" fill="#fff" fill-opacity=".22"/><path d="${path}" stroke="#fff" stroke-width="2.4" stroke-linecap="round" fill="none"/></svg>`,
  )}`;
export const PLUS = icon("M12 7v10M7 12h10");
export const MINUS = icon("M7 12h10");
export const CLOCK = icon("M12 5a7 7 0 1 0 .01 0M12 8v4l3 2");

type Act = (block: Blockly.BlockSvg, field: Blockly.FieldImage) => void;

/** A small picture to press. */
export function button(src: string, label: string, act: Act): Blockly.FieldImage {
  return new Blockly.FieldImage(src, 22, 22, label, (field) => act(field.getSourceBlock() as Blockly.BlockSvg, field));
}

export function topicField(suggest: Suggestions, label: string): SuggestionField {
  return new SuggestionField("/odom", () => suggest.markedTopics(), label, oneWord as Blockly.FieldTextInputValidator);
}

export function propertyField(value: string, properties: () => readonly string[]): SuggestionField {
  return new SuggestionField(value, properties, "property", oneWord as Blockly.FieldTextInputValidator);
}

export function numberField(value: string, label: string, minimum?: number): Blockly.FieldNumber {
  const field = new NumberField(value, minimum);
  field.setAriaTypeName(label);
  return field;
}

export function textField(value: string, label: string, validator?: (text: string) => string | null) {
  const field = new Blockly.FieldTextInput(value, (validator ?? null) as never, { spellcheck: false });
  field.setAriaTypeName(label);
  return field;
}

export function operatorField(label?: string): Blockly.FieldDropdown {
  return choiceField(OPERATORS, label);
}

export function timeUnitField(label: string): Blockly.FieldDropdown {
  return choiceField(TIME_UNITS, label);
}

/** A list to choose from; `label` is what a screen reader says before the choice. */
export function choiceField(choices: [string, string][], label?: string): Blockly.FieldDropdown {
  const field = new Blockly.FieldDropdown(choices);
  if (label !== undefined) field.setAriaTypeName(label);
  return field;
}

/** Lets blocks of one type stand below each other. */
export function chain(block: Blockly.BlockSvg, type: string, style: string): void {
  block.setPreviousStatement(true, type);
  block.setNextStatement(true, type);
  block.setStyle(style);
}
