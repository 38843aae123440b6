// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import * as Blockly from "blockly/core";
import { Picker } from "../ui/picker";
import type { PickerChoice } from "../ui/picker_matches";
import { type QuietField, takeKey } from "./open_field";

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
export function oneWord(text: string): string | null {
  const word = text.trim();
  return /^\S+$/.test(word) ? word : null;
}
