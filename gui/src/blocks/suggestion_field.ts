// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";

/** What can be suggested for a field, asked when somebody starts to type. */
export type Suggest = (field: SuggestionField) => readonly string[];

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
    for (const word of this.suggest(this)) list.append(new Option(word, word));
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
