// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";

/** A word to suggest, and what is said beside it. */
export type Suggestion = string | { word: string; note: string };
/** What can be suggested for a field, asked when somebody starts to type. */
export type Suggest = (field: SuggestionField) => readonly Suggestion[];

/** A text field with suggestions. Unlike a drop-down it keeps a value that nobody knows. */
export class SuggestionField extends Blockly.FieldTextInput {
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
    for (const each of this.suggest(this)) {
      const { word, note } = typeof each === "string" ? { word: each, note: each } : each;
      list.append(new Option(note, word));
    }
    input.after(list);
    input.setAttribute("list", list.id);
    input.setAttribute("aria-label", this.label);
    return input;
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
