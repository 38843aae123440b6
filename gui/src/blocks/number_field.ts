// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { typedNumber } from "../ui/numbers";

/** A field for a number; what is none leaves it as it was. Blockly's own drops commas, so that 3,5 would be 35. */
export class NumberField extends Blockly.FieldNumber {
  protected override doClassValidation_(value?: unknown): number | null {
    const number = typedNumber(String(value ?? ""));
    return Number.isFinite(number) ? super.doClassValidation_(number) : null;
  }
}
