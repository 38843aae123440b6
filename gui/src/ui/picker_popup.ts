// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Found } from "./picker_matches";
import { watchSize } from "./watch";

const GAP_PX = 4;
const EDGE_PX = 8;
const LEAST_HEIGHT_PX = 120;
const MOST_HEIGHT_PX = 340;
const WIDTH_PX = 380;
const FOLLOW_MS = 100;

let made = 0;

/** A list, or a word of warning, below a text field or above it: wherever it is not cut off. */
export class PickerPopup {
  readonly listId: string;
  private readonly box = document.createElement("div");
  private readonly list = document.createElement("ul");
  private readonly note = document.createElement("p");
  private readonly closed = new AbortController();
  private place = "";
  /** Whether a press began in the list. */
  private isPressed = false;

  constructor(
    private readonly input: HTMLInputElement,
    label: string,
    private readonly pressed: (at: number) => void,
  ) {
    this.listId = `picker-${++made}`;
    this.box.className = "picker";
    this.list.id = this.listId;
    this.list.setAttribute("role", "listbox");
    this.list.setAttribute("aria-label", label);
    this.note.id = `${this.listId}-note`;
    this.note.setAttribute("role", "status");
    this.box.append(this.list, this.note);
    // Above everything else, and not cut off by what scrolls around the field.
    this.box.popover = "manual";
    // The field keeps the focus. A finger that opened the field must not choose what comes up below it.
    this.box.addEventListener("pointerdown", (event) => {
      this.isPressed = true;
      event.preventDefault();
    });
    this.box.addEventListener("mousedown", (event) => event.preventDefault());
    this.list.addEventListener("click", (event) => this.click(event));
    input.after(this.box);
    this.box.showPopover();
    this.follow();
  }

  /** Shows choices, pointing at one of them, and a note below. */
  show(found: readonly Found[], active: number, { note, isProblem }: { note: string; isProblem: boolean }): void {
    this.list.replaceChildren(...found.map((one, at) => this.option(one, at)));
    this.list.hidden = found.length === 0;
    this.note.textContent = note;
    this.note.hidden = note === "";
    this.note.classList.toggle("problem", isProblem);
    this.box.hidden = found.length === 0 && note === "";
    this.input.setAttribute("aria-expanded", String(found.length > 0));
    if (note === "") this.input.removeAttribute("aria-describedby");
    else this.input.setAttribute("aria-describedby", this.note.id);
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

  dispose(): void {
    this.closed.abort();
    this.box.remove();
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

  /** Stays with the field, which moves when blocks grow and when the page scrolls. */
  private follow(): void {
    const settle = () => this.settle();
    settle();
    const { signal } = this.closed;
    for (const event of ["scroll", "resize"]) addEventListener(event, settle, { capture: true, signal });
    const stopWatching = watchSize(this.input, settle);
    // A look at each frame would have the page draw one after the other.
    const timer = setInterval(settle, FOLLOW_MS);
    signal.addEventListener("abort", () => {
      stopWatching();
      clearInterval(timer);
    });
  }

  private settle(): void {
    const field = this.input.getBoundingClientRect();
    const { width, height } = visualViewport ?? { width: innerWidth, height: innerHeight };
    const below = height - field.bottom - GAP_PX - EDGE_PX;
    const above = field.top - GAP_PX - EDGE_PX;
    const isBelow = below >= Math.min(MOST_HEIGHT_PX, this.box.scrollHeight) || below >= above;
    const room = Math.max(Math.min(isBelow ? below : above, MOST_HEIGHT_PX), LEAST_HEIGHT_PX);
    const wide = Math.min(Math.max(WIDTH_PX, field.width), width - 2 * EDGE_PX);
    const left = Math.max(Math.min(field.left, width - wide - EDGE_PX), EDGE_PX);
    const place = `left:${left}px;width:${wide}px;max-height:${room}px;${
      isBelow ? `top:${field.bottom + GAP_PX}px` : `bottom:${innerHeight - field.top + GAP_PX}px`
    }`;
    if (place === this.place) return;
    this.place = place;
    this.box.style.cssText = place;
  }
}

function part(name: string, text: string): HTMLSpanElement {
  const span = document.createElement("span");
  span.className = name;
  span.textContent = text;
  return span;
}
