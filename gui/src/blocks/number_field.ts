// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { effect, type Signal, signal } from "@preact/signals";
import * as Blockly from "blockly/core";
import { numberProblem, typedNumber } from "../ui/numbers";
import { FieldPopup } from "../ui/picker";
import { type QuietField, takeKey } from "./open_field";

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

/**
 * Draws what the check of a block reads, with `threshold` as a line, until the returned function is called; null where
 * there are no values.
 */
export type DrawValues = (host: HTMLElement, block: Blockly.Block, threshold: Signal<number>) => (() => void) | null;

const KEYS = new Set(["ArrowUp", "ArrowDown", "PageUp", "PageDown"]);

/** The number of a check. A click or an arrow key shows the values that it is compared with; dragging there types. */
export class ThresholdField extends NumberField implements QuietField {
  private isQuiet = false;
  private stop: (() => void) | null = null;

  constructor(
    value: string,
    label: string,
    private readonly draw: DrawValues,
  ) {
    super(value, label);
  }

  openQuietly(): void {
    this.isQuiet = true;
    this.showEditor();
    this.isQuiet = false;
  }

  protected override widgetCreate_(): HTMLInputElement {
    const input = super.widgetCreate_();
    input.addEventListener("click", () => this.showValues(input));
    if (!this.isQuiet) this.showValues(input);
    return input;
  }

  protected override onHtmlInputKeyDown_(event: KeyboardEvent): void {
    const input = this.htmlInput_;
    if (!KEYS.has(event.key) || input === null) {
      super.onHtmlInputKeyDown_(event);
      return;
    }
    event.preventDefault();
    if (this.stop === null) this.showValues(input);
    else input.parentElement?.querySelector("[role=slider]")?.dispatchEvent(new KeyboardEvent("keydown", event));
  }

  protected override widgetDispose_(): void {
    this.stop?.();
    this.stop = null;
    super.widgetDispose_();
  }

  private showValues(input: HTMLInputElement): void {
    const block = this.getSourceBlock();
    if (this.stop !== null || block === null) return;
    const threshold = signal(Number(this.getValue()));
    const host = document.createElement("div");
    host.className = "picker-chart";
    const close = this.draw(host, block, threshold);
    if (close === null) return;
    this.below(input).hold(host);
    const typed = () => {
      const value = typedNumber(input.value);
      if (Number.isFinite(value)) threshold.value = value;
    };
    input.addEventListener("input", typed);
    const follow = effect(() => {
      const { value } = threshold;
      if (value === typedNumber(input.value)) return;
      input.value = String(value);
      input.dispatchEvent(new Event("input"));
    });
    this.stop = () => {
      follow();
      close();
    };
  }
}
