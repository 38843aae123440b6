// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { effect } from "@preact/signals";
import * as Blockly from "blockly/core";
import type { DurationUnit, Operator } from "../api/types";
import { Picker, type PickerChoice } from "../ui/picker";
import { isForFingers } from "../ui/watch";
import { ComparedField, type DrawValues, NumberField } from "./number_field";
import { openNext, type QuietField, takeKey } from "./open_field";
import type { Zone } from "./zones";

/** What an action names: the node of a parameter, a parameter of some node, or a service. */
export type Allowed = { kind: "node" | "service" } | { kind: "parameter"; node: string };

/** What the blocks suggest. */
export interface Suggestions {
  topics(): readonly string[];
  /** Topics with their types, rates and users. */
  topicChoices(): readonly PickerChoice[];
  /** Patterns that stand for all topics of a kind. */
  patternChoices(): readonly PickerChoice[];
  /** What checks can name in the place of a topic: the machine and the link. */
  vitalsChoices(): readonly PickerChoice[];
  /** What checks can read of a topic. */
  properties(topic: string): readonly PickerChoice[];
  /** What a bound can be about, what only bounds can name first. */
  bounds(topic: string): readonly PickerChoice[];
  /** Every message, none, or a level with the rates that it means. */
  rates(topic: string): readonly PickerChoice[];
  /** Levels of a bound with the numbers that they mean. */
  boundLevels(topic: string, property: string): readonly PickerChoice[];
  /** What a property can be equal to, in words; null where it is a number for sure. */
  words(topic: string, property: string): readonly PickerChoice[] | null;
  /** What the rules may set and call on the robot. */
  allowed(what: Allowed): readonly PickerChoice[];
  unit(topic: string, property: string): string;
  /** Why a name that is typed is none that anybody knows; empty where nobody could know it. */
  unknown(): string;
  /** The zones of the rules of the file. */
  zones(): readonly Zone[];
  drawValues: DrawValues;
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
/** What blocks of a condition are to connections. */
export const CONDITION = "Condition";
export const PLUS = icon("M12 7v10M7 12h10");
export const MINUS = icon("M7 12h10");
export const SWITCH = icon("M12 6v6M8.2 8.6a5.6 5.6 0 1 0 7.6 0");
export const COPY = icon("M7 7h7v7h-7zM10.5 17.5h7v-7");
export const OPEN = icon("M10 8l4 4-4 4");
export const SHUT = icon("M8 10l4 4 4-4");
export const SLOPE = icon("M6 17h3l6-9h3");
export const CLOCK = icon("M12 5a7 7 0 1 0 .01 0M12 8v4l3 2");

/** In the units of blocks; at the scale for fingers more than 24 px. */
const [SIZE, SIZE_FOR_FINGERS] = [22, 28];

type Act = (block: Blockly.BlockSvg, field: Blockly.FieldImage) => void;

/** A small picture to press. */
export function button(src: string, label: string, act: Act): Blockly.FieldImage {
  return new PictureField(src, label, act, false);
}

/** One that is seen where somebody is at its block: with the mouse over it, or with the focus in it. */
export function quietButton(src: string, label: string, act: Act): Blockly.FieldImage {
  return new PictureField(src, label, act, true);
}

/** Words that are seen as a quiet button is. */
export function quietWords(words: string): Blockly.FieldLabel {
  return new Blockly.FieldLabel(words, QUIET);
}

const QUIET = "quiet-field";

class PictureField extends Blockly.FieldImage {
  constructor(
    src: string,
    label: string,
    act: Act,
    private readonly isQuiet: boolean,
  ) {
    const size = isForFingers() ? SIZE_FOR_FINGERS : SIZE;
    super(src, size, size, label, (field) => act(field.getSourceBlock() as Blockly.BlockSvg, field));
  }

  override initView(): void {
    super.initView();
    if (this.isQuiet) this.fieldGroup_?.classList.add(QUIET);
  }
}

/** A name of a topic, and of `others` that can stand in its place. */
export function topicField(
  suggest: Suggestions,
  label: string,
  others: () => readonly PickerChoice[] = () => [],
): SuggestionField {
  const offer = {
    hint: "Any other name is kept as typed",
    choices: () => [...suggest.topicChoices(), ...others()],
    unknown: () => suggest.unknown(),
    // A text with a slash is a name; without it, a search.
    isWhole: (text: string) => text.startsWith("/"),
    refusal: (text: string) => (oneWord(text) === null ? "A topic's name is one word, such as /odom" : ""),
  };
  return new SuggestionField("/odom", offer, label, oneWord as Blockly.FieldTextInputValidator);
}

export function propertyField(
  value: string,
  choices: (topic: string) => readonly PickerChoice[],
  topic = "TOPIC",
): SuggestionField {
  const offer = {
    hint: 'Any field of the message can be typed, such as pose.pose.position.z or status["lidar"].level',
    choices: (block: Blockly.Block) => choices(textOf(block, topic)),
    // A path of fields, such as pose.covariance[0].
    isWhole: (text: string) => /[.[]/.test(text),
    refusal: (text: string) => (oneProperty(text) === null ? "A property is one word, such as pose_x" : ""),
  };
  return new SuggestionField(value, offer, "property", oneProperty as Blockly.FieldTextInputValidator);
}

/** A name of one word, from a list or any other. */
export function nameField(
  value: string,
  label: string,
  hint: string,
  choices: (block: Blockly.Block) => readonly PickerChoice[],
): SuggestionField {
  const refusal = (text: string) => (oneWord(text) === null ? "A name is one word" : "");
  const offer = { hint, choices, isWhole: (text: string) => text.startsWith("/"), refusal };
  return new SuggestionField(value, offer, label, oneWord as Blockly.FieldTextInputValidator);
}

/** What a field of a block says. */
export function textOf(block: Blockly.Block, field: string): string {
  return String(block.getFieldValue(field));
}

export function numberField(value: string, label: string, minimum?: number): Blockly.FieldNumber {
  return new NumberField(value, label, minimum);
}

export function priorityField(): Blockly.FieldNumber {
  return new PriorityField("0", "priority of the rule");
}

/** What a check compares with, beside the words or the values of its property. */
export function comparedField(suggest: Suggestions): Blockly.FieldNumber {
  const words = (block: Blockly.Block) => suggest.words(textOf(block, "TOPIC"), textOf(block, "PROPERTY"));
  return new ComparedField("0", "value", words, (...of) => suggest.drawValues(...of));
}

export function textField(
  value: string,
  label: string,
  placeholder: string,
  validator?: (text: string) => string | null,
): Blockly.FieldTextInput {
  return new TextField(value, label, placeholder, validator);
}

export function operatorField(label?: string): Blockly.FieldDropdown {
  return choiceField(OPERATORS, label);
}

export function timeUnitField(label: string): Blockly.FieldDropdown {
  return choiceField(TIME_UNITS, label);
}

/** A list to choose from; `label` is what a screen reader says before the choice. */
export function choiceField(choices: [string, string][], label?: string): Blockly.FieldDropdown {
  const field = new ChoiceField(choices);
  if (label !== undefined) field.setAriaTypeName(label);
  return field;
}

/** Lets blocks of one type stand below each other. */
export function chain(block: Blockly.BlockSvg, type: string, style: string): void {
  block.setPreviousStatement(true, type);
  block.setNextStatement(true, type);
  block.setStyle(style);
}

/** Of rules that clash the one with the greater number wins; 0, which most have, is shown where somebody is at the rule. */
class PriorityField extends NumberField {
  protected override getDisplayText_(): string {
    this.fieldGroup_?.classList.toggle(QUIET, this.getText() === "0");
    return `priority ${super.getDisplayText_()}`;
  }
}

/** A field with a list to choose from; Tab takes what is marked in the open list and goes on to the next field. */
export class ChoiceField extends Blockly.FieldDropdown {
  protected override showEditor_(event?: MouseEvent): void {
    super.showEditor_(event);
    const list = this.menu_?.getElement();
    list?.addEventListener("keydown", (key) => {
      if (key.key !== "Tab") return;
      key.preventDefault();
      key.stopPropagation();
      list.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
      openNext(this, key.shiftKey);
    });
  }
}

/** A field for a text; while it is empty it says what belongs there. */
class TextField extends Blockly.FieldTextInput {
  constructor(
    value: string,
    private readonly label: string,
    private readonly placeholder: string,
    validator?: (text: string) => string | null,
  ) {
    super(value, (validator ?? null) as never, { spellcheck: false });
    this.setAriaTypeName(label);
  }

  protected override widgetCreate_(): HTMLInputElement {
    const input = super.widgetCreate_() as HTMLInputElement;
    input.setAttribute("aria-label", this.label);
    input.placeholder = this.placeholder;
    return input;
  }

  protected override onHtmlInputKeyDown_(event: KeyboardEvent): void {
    if (!takeKey(this, event, false)) super.onHtmlInputKeyDown_(event);
  }

  protected override getDisplayText_(): string {
    const isEmpty = this.getText() === "";
    this.fieldGroup_?.classList.toggle("placeholder", isEmpty);
    return isEmpty ? this.placeholder : super.getDisplayText_();
  }
}

/** What a field offers, and what it keeps that it does not offer. */
interface Offer {
  /** What can be typed beside what is offered. */
  hint: string;
  /** What can be picked for a block, asked when its field opens and when the signals that it reads change. */
  choices(block: Blockly.Block): readonly PickerChoice[];
  /** Whether a text means itself, so that Enter keeps it even if something longer could be meant. */
  isWhole(text: string): boolean;
  /** Why a text cannot be kept; empty where it can. */
  refusal(text: string): string;
  /** What of a typed text stays before what is picked. */
  head?(text: string): string;
  /** What is said of a text that nobody knows. */
  unknown?(): string;
}

/** A text field to pick for. Unlike a drop-down it keeps a value that nobody knows. */
export class SuggestionField extends Blockly.FieldTextInput implements QuietField {
  private isQuiet = false;
  private picker: Picker | null = null;
  private stop: (() => void) | null = null;

  constructor(
    value: string,
    private readonly offer: Offer,
    private readonly label: string,
    validator?: Blockly.FieldTextInputValidator,
  ) {
    super(value, validator, { spellcheck: false });
  }

  openQuietly(): void {
    this.isQuiet = true;
    this.showEditor();
    this.isQuiet = false;
  }

  protected override widgetCreate_(): HTMLInputElement {
    const input = super.widgetCreate_() as HTMLInputElement;
    const { offer } = this;
    input.setAttribute("aria-label", this.label);
    this.picker = new Picker(input, !this.isQuiet, {
      label: this.label,
      hint: offer.hint,
      choices: () => offer.choices(this.getSourceBlock() as Blockly.Block),
      isWhole: (text) => offer.isWhole(text),
      refusal: (text) => offer.refusal(text),
      head: (text) => offer.head?.(text) ?? "",
      unknown: () => offer.unknown?.() ?? "",
      pressed: () => Blockly.WidgetDiv.hideIfOwner(this),
    });
    this.stop = effect(() => this.picker?.refresh());
    return input;
  }

  protected override onHtmlInputKeyDown_(event: KeyboardEvent): void {
    if (this.picker?.keyDown(event) || takeKey(this, event, Boolean(this.picker?.refusal))) return;
    if (event.key === "Escape") this.leave();
    super.onHtmlInputKeyDown_(event);
  }

  protected override widgetDispose_(): void {
    const { picker } = this;
    if (picker && picker.refusal === "") this.setEditorValue_(picker.word, false);
    this.leave();
    super.widgetDispose_();
  }

  private leave(): void {
    this.stop?.();
    this.stop = null;
    this.picker?.dispose();
    this.picker = null;
  }

  protected override getDisplayText_(): string {
    return `${super.getDisplayText_()} ▾`;
  }

  override getAriaTypeName(): string {
    return this.label;
  }
}

/** Trims; an empty text, or one with blanks inside, is refused. */
function oneWord(text: string): string | null {
  const word = text.trim();
  return /^\S+$/.test(word) ? word : null;
}

/** As `oneWord`; the name of an element may have blanks inside its quotes. */
function oneProperty(text: string): string | null {
  const word = text.trim();
  return /^(?:[^\s"]|\["(?:[^"\\]|\\.)*"\])+$/.test(word) ? word : null;
}
