// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import * as Blockly from "blockly/core";

/** A word to suggest, and what is said beside it. */
export type Suggestion = string | { word: string; note: string };
/** What can be suggested for a field, asked when somebody starts to type and when the signals that it reads change. */
export type Suggest = (field: SuggestionField) => readonly Suggestion[];

/** A text field with suggestions. Unlike a drop-down it keeps a value that nobody knows. */
export class SuggestionField extends Blockly.FieldTextInput {
  private stop: (() => void) | null = null;

  constructor(
    value: string,
    private readonly suggest: Suggest,
    private readonly label: string,
    validator?: Blockly.FieldTextInputValidator,
  ) {
    super(value, validator, { spellcheck: false });
  }

  protected override widgetCreate_(): HTMLInputElement {
    const input = super.widgetCreate_() as HTMLInputElement;
    const list = document.createElement("datalist");
    list.id = Blockly.utils.idGenerator.getNextUniqueId();
    this.stop = effect(() => list.replaceChildren(...this.suggest(this).map(option)));
    input.after(list);
    input.setAttribute("list", list.id);
    input.setAttribute("aria-label", this.label);
    return input;
  }

  protected override widgetDispose_(): void {
    this.stop?.();
    this.stop = null;
    super.widgetDispose_();
  }

  override getAriaTypeName(): string {
    return this.label;
  }
}

function option(suggestion: Suggestion): HTMLOptionElement {
  return typeof suggestion === "string"
    ? new Option(suggestion, suggestion)
    : new Option(suggestion.note, suggestion.word);
}

/** Trims; an empty text, or one with blanks inside, is refused. */
export function oneWord(text: string): string | null {
  const word = text.trim();
  return /^\S+$/.test(word) ? word : null;
}
