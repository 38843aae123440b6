// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { FieldPopup } from "./field_popup";
import type { Found } from "./picker_matches";

const WIDTH_PX = 380;

/** A list of choices for a text field. */
export class PickerPopup extends FieldPopup {
  readonly listId = this.id;
  private readonly list = document.createElement("ul");
  /** Whether a press began in the list. */
  private isPressed = false;

  constructor(
    input: HTMLInputElement,
    label: string,
    private readonly pressed: (at: number) => void,
  ) {
    super(input, WIDTH_PX);
    this.list.id = this.listId;
    this.list.setAttribute("role", "listbox");
    this.list.setAttribute("aria-label", label);
    // A finger that opened the field must not choose what comes up below it.
    this.box.addEventListener("pointerdown", (event) => {
      this.isPressed = true;
      event.preventDefault();
    });
    this.list.addEventListener("click", (event) => this.click(event));
    this.hold(this.list);
  }

  /** Shows choices, pointing at one of them, and a note below. */
  show(found: readonly Found[], active: number, { note, isProblem }: { note: string; isProblem: boolean }): void {
    this.list.replaceChildren(...found.map((one, at) => this.option(one, at)));
    this.list.hidden = found.length === 0;
    this.say(note, isProblem);
    this.box.hidden = found.length === 0 && note === "";
    this.input.setAttribute("aria-expanded", String(found.length > 0));
    this.point(active);
  }

  hide(): void {
    this.box.hidden = true;
    this.input.setAttribute("aria-expanded", "false");
  }

  /** Points at one of the choices; -1 at none. */
  point(active: number): void {
    for (const [at, option] of [...this.list.children].entries()) {
      option.setAttribute("aria-selected", String(at === active));
    }
    const option = this.list.children[active];
    if (option === undefined) {
      this.input.removeAttribute("aria-activedescendant");
      return;
    }
    this.input.setAttribute("aria-activedescendant", option.id);
    this.settle();
    option.scrollIntoView({ block: "nearest" });
  }

  private option({ choice }: Found, at: number): HTMLLIElement {
    const option = document.createElement("li");
    option.id = `${this.listId}-${at}`;
    option.setAttribute("role", "option");
    option.append(part("word", choice.word));
    if (choice.aside) option.append(" ", part("aside", choice.aside));
    if (choice.note) option.append(" ", part("note", choice.note));
    return option;
  }

  private click(event: MouseEvent): void {
    if (!this.isPressed) return;
    const option = (event.target as Element).closest("[role=option]");
    const at = option === null ? -1 : [...this.list.children].indexOf(option);
    if (at >= 0) this.pressed(at);
  }
}

function part(name: string, text: string): HTMLSpanElement {
  const span = document.createElement("span");
  span.className = name;
  span.textContent = text;
  return span;
}
