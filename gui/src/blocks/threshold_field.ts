// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal, signal } from "@preact/signals";
import type * as Blockly from "blockly/core";
import { typedNumber } from "../ui/numbers";
import { NumberField } from "./number_field";
import type { QuietField } from "./open_field";

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
