// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { openNext } from "./open_field";

/** A field with a list to choose from; Tab takes what is marked in the open list and goes on to the next field. */
export class ChoiceField extends Blockly.FieldDropdown {
  protected override showEditor_(event?: MouseEvent): void {
    super.showEditor_(event);
    const list = this.menu_?.getElement();
    list?.addEventListener("keydown", (key) => {
      if (key.key !== "Tab") return;
      key.preventDefault();
      key.stopPropagation();
      list.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
      openNext(this, key.shiftKey);
    });
  }
}
