// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { takeKey } from "./open_field";

/** A field for a text; while it is empty it says what belongs there. */
export class TextField extends Blockly.FieldTextInput {
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
