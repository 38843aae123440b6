// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { FieldPopup } from "../ui/field_popup";
import { numberProblem, typedNumber } from "../ui/numbers";
import { takeKey } from "./open_field";

const WIDTH_PX = 380;

/** A field for a number; what is none is said, and is not kept. Blockly's own drops commas, so that 3,5 would be 35. */
export class NumberField extends Blockly.FieldNumber {
  private popup: FieldPopup | null = null;

  constructor(
    value: string,
    private readonly label: string,
    minimum?: number,
  ) {
    super(value, minimum);
    this.setAriaTypeName(label);
  }

  protected override doClassValidation_(value?: unknown): number | null {
    const number = typedNumber(String(value ?? ""));
    return Number.isFinite(number) ? super.doClassValidation_(number) : null;
  }

  protected override widgetCreate_(): HTMLInputElement {
    const input = super.widgetCreate_();
    input.inputMode = "decimal";
    input.setAttribute("aria-label", this.label);
    input.addEventListener("input", () => this.say(input));
    return input;
  }

  protected override onHtmlInputKeyDown_(event: KeyboardEvent): void {
    const input = this.htmlInput_;
    if (takeKey(this, event, input !== null && this.problem(input.value) !== "")) return;
    super.onHtmlInputKeyDown_(event);
  }

  protected override widgetDispose_(): void {
    this.popup?.dispose();
    this.popup = null;
    super.widgetDispose_();
  }

  /** Why a text is not taken; empty if it is. */
  private problem(text: string): string {
    const least = this.getMin();
    return numberProblem(text) || (typedNumber(text) < least ? `${text.trim()} is less than ${least}` : "");
  }

  /** Says below the field why its text is not taken. */
  private say(input: HTMLInputElement): void {
    const note = this.problem(input.value);
    if (note === "" && this.popup === null) return;
    this.below(input).say(note, true);
  }

  /** What stands below the field while it is open. */
  protected below(input: HTMLInputElement): FieldPopup {
    this.popup ??= new FieldPopup(input, WIDTH_PX);
    return this.popup;
  }
}
