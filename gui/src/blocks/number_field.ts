// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { effect, type Signal, signal } from "@preact/signals";
import * as Blockly from "blockly/core";
import { numberProblem, typedNumber } from "../ui/numbers";
import { FieldPopup, Picker, type PickerChoice } from "../ui/picker";
import { comparedIn, comparedProblem, isOfEquality, isWholeCompared, parseCompared } from "./compared";
import { type QuietField, takeKey } from "./open_field";

const WIDTH_PX = 380;

/** A field for a number; what is none is said, and is not kept. Blockly's own drops commas, so that 3,5 would be 35. */
export class NumberField extends Blockly.FieldNumber {
  private popup: FieldPopup | null = null;

  constructor(
    value: string,
    protected readonly label: string,
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
  protected problem(text: string): string {
    const least = this.getMin();
    return numberProblem(text) || (typedNumber(text) < least ? `${text.trim()} is less than ${least}` : "");
  }

  /** Says below the field why its text is not taken. */
  protected say(input: HTMLInputElement): void {
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

/** The words that a check can compare with; null where its property is a number for sure. */
export type WordsOf = (block: Blockly.Block) => readonly PickerChoice[] | null;

/**
 * What a check compares with. A click or an arrow key shows the words to choose from, or else the values that a number is
 * compared with; dragging there types.
 */
export class ComparedField extends NumberField implements QuietField {
  private isQuiet = false;
  private stop: (() => void) | null = null;
  private stopWaiting: (() => void) | null = null;
  private picker: Picker | null = null;

  constructor(
    value: string,
    label: string,
    private readonly words: WordsOf,
    private readonly draw: DrawValues = () => null,
  ) {
    super(value, label);
  }

  /** A field for what ends the same check. */
  forEnd(label: string): Blockly.FieldNumber {
    return new ComparedField("0", label, this.words);
  }

  openQuietly(): void {
    this.isQuiet = true;
    this.showEditor();
    this.isQuiet = false;
  }

  /** Blockly's own takes numbers alone. */
  protected override doClassValidation_(value?: unknown): number | null {
    const number = super.doClassValidation_(value);
    return number ?? (parseCompared(String(value ?? "")) as number | null);
  }

  protected override widgetCreate_(): HTMLInputElement {
    const input = super.widgetCreate_();
    if (this.choices() !== null) input.inputMode = "text";
    if (this.offersWords) this.pick(input);
    else {
      input.addEventListener("click", () => this.showValues(input));
      if (!this.isQuiet) this.showValues(input);
      // The words of a recording come when it was read.
      this.stopWaiting = effect(() => {
        if (this.offersWords) queueMicrotask(() => this.turnToWords(input));
      });
    }
    return input;
  }

  protected override onHtmlInputKeyDown_(event: KeyboardEvent): void {
    const input = this.htmlInput_;
    if (this.picker?.keyDown(event)) return;
    if (this.picker !== null || !KEYS.has(event.key) || input === null) {
      if (event.key === "Escape") this.leave();
      super.onHtmlInputKeyDown_(event);
      return;
    }
    event.preventDefault();
    if (this.stop === null) this.showValues(input);
    else input.parentElement?.querySelector("[role=slider]")?.dispatchEvent(new KeyboardEvent("keydown", event));
  }

  protected override widgetDispose_(): void {
    const { picker } = this;
    if (picker?.refusal === "") this.setEditorValue_(picker.word, false);
    this.leave();
    super.widgetDispose_();
    const block = this.getSourceBlock();
    const operator = this.name?.replace("VALUE", "OP") ?? "";
    if (!block || !isOfEquality(comparedIn(this.getValue())) || block.isDisposed()) return;
    if (!["=", "!="].includes(String(block.getFieldValue(operator)))) block.setFieldValue("=", operator);
  }

  protected override problem(text: string): string {
    return this.choices() === null ? super.problem(text) : comparedProblem(text);
  }

  protected override say(input: HTMLInputElement): void {
    // The list says it itself.
    if (this.picker === null) super.say(input);
  }

  private choices(): readonly PickerChoice[] | null {
    const block = this.getSourceBlock();
    return block === null ? [] : this.words(block);
  }

  /** Whether there are words to choose from, or the field has one. */
  private get offersWords(): boolean {
    return (this.choices() ?? []).length > 0 || typeof comparedIn(this.getValue()) === "string";
  }

  private turnToWords(input: HTMLInputElement): void {
    if (this.htmlInput_ !== input || this.picker !== null) return;
    this.leave();
    this.pick(input);
  }

  private pick(input: HTMLInputElement): void {
    const picker = new Picker(input, !this.isQuiet, {
      label: this.label,
      hint: "Or type a number, a text or a constant",
      choices: () => this.choices() ?? [],
      isWhole: isWholeCompared,
      refusal: (text) => this.problem(text),
      head: () => "",
      unknown: () => "",
      pressed: () => Blockly.WidgetDiv.hideIfOwner(this),
    });
    this.picker = picker;
    this.stop = effect(() => picker.refresh());
  }

  private leave(): void {
    this.stop?.();
    this.stopWaiting?.();
    this.stop = this.stopWaiting = null;
    this.picker?.dispose();
    this.picker = null;
  }

  private showValues(input: HTMLInputElement): void {
    const block = this.getSourceBlock();
    if (this.stop !== null || this.picker !== null || block === null) return;
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
