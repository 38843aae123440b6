// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { FieldPopup } from "./field_popup";
import { type Found, matching, type PickerChoice } from "./picker_matches";

/** What a picker offers and what it may keep. */
interface PickerOwner {
  /** What is picked, such as "topic to send". */
  label: string;
  /** What can be typed beside what is offered. */
  hint: string;
  choices(): readonly PickerChoice[];
  /** What of a typed text stays before what is picked: topics that were named already. */
  head(text: string): string;
  /** Whether a text means itself, so that Enter keeps it even if something longer could be meant. */
  isWhole(text: string): boolean;
  /** Why a text cannot be kept; empty where it can. */
  refusal(text: string): string;
  /** Somebody pressed a choice: it is taken, and the picking is over. */
  pressed(word: string): void;
}

const NONE = -1;
const PAGE = 8;

/**
 * A list of choices below a text field: a combobox with a listbox, as the ARIA Authoring Practices describe them.
 *
 * Typing filters; what is typed in full, or means itself, is kept as typed.
 */
export class Picker {
  private readonly popup: PickerPopup;
  private found: readonly Found[] = [];
  private active = NONE;
  private isTyped = false;

  constructor(
    private readonly input: HTMLInputElement,
    /** Whether the list is open; typing, a click and the arrow keys open it. */
    private isOpen: boolean,
    private readonly owner: PickerOwner,
  ) {
    this.popup = new PickerPopup(input, owner.label, (at) => this.press(at));
    input.setAttribute("role", "combobox");
    input.setAttribute("aria-autocomplete", "list");
    input.setAttribute("aria-controls", this.popup.listId);
    input.autocomplete = "off";
    input.addEventListener("input", () => {
      this.isTyped = true;
      this.open();
    });
    input.addEventListener("click", () => this.open());
    this.refresh();
  }

  /** Offers what the owner has by now. */
  refresh(): void {
    const text = this.tail;
    const before = this.found[this.active]?.choice.word;
    this.found = matching(this.owner.choices(), this.isTyped ? text : "");
    const isOpenEnded = this.isTyped && text !== "" && !this.owner.isWhole(text);
    const kept = this.found.findIndex(({ choice }) => choice.word === before);
    const same = this.found.findIndex(({ choice }) => choice.word.toLowerCase() === text.toLowerCase());
    const best = isOpenEnded && this.found[0]?.isByName ? 0 : NONE;
    this.active = same >= 0 ? same : this.isTyped ? best : kept;
    const isOffered = this.found.some(({ choice }) => choice.word === text);
    const asTyped = best === 0 && !isOffered && this.owner.refusal(text) === "" ? text : null;
    if (asTyped !== null) this.found = [...this.found, asItIs(asTyped)];
    const refusal = this.isTyped && this.active === NONE ? this.owner.refusal(text) : "";
    const isNew = this.found.length === 0 && text !== "" && this.owner.isWhole(text);
    const note = refusal || (isNew ? `“${text}” is kept as typed` : this.owner.hint);
    if (this.isOpen) this.popup.show(this.found, this.active, { note, isProblem: refusal !== "" });
    else this.popup.hide();
  }

  /** Does what a key means in the list; whether it meant anything there. */
  keyDown(event: KeyboardEvent): boolean {
    const last = this.found.length - 1;
    const moves: Record<string, number> = {
      ArrowDown: this.active >= last ? 0 : this.active + 1,
      ArrowUp: this.active <= 0 ? last : this.active - 1,
      PageDown: Math.min(this.active + PAGE, last),
      PageUp: Math.max(this.active - PAGE, 0),
    };
    const next = moves[event.key];
    if (next === undefined || event.ctrlKey || event.altKey || event.metaKey) return false;
    event.preventDefault();
    event.stopPropagation();
    if (!this.isOpen) this.open();
    else if (last >= 0) {
      this.active = next;
      this.popup.point(next);
    }
    return true;
  }

  /** What is to be kept: the choice that is pointed at, else what is typed. */
  get word(): string {
    const chosen = this.found[this.active]?.choice.word;
    return chosen === undefined ? this.input.value : this.head + chosen;
  }

  /** Why what is to be kept cannot be; it is said below the field. */
  get refusal(): string {
    return this.active === NONE ? this.owner.refusal(this.tail) : "";
  }

  dispose(): void {
    this.popup.dispose();
  }

  private open(): void {
    this.isOpen = true;
    this.refresh();
  }

  private get head(): string {
    return this.isTyped ? this.owner.head(this.input.value) : "";
  }

  /** The part of the text that something is picked for. */
  private get tail(): string {
    return this.input.value.slice(this.head.length).trim();
  }

  private press(at: number): void {
    this.active = at;
    this.owner.pressed(this.word);
  }
}

function asItIs(text: string): Found {
  return { choice: { word: text, note: "as typed" }, isByName: true };
}

const WIDTH_PX = 380;

/** A list of choices for a text field. */
class PickerPopup extends FieldPopup {
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
