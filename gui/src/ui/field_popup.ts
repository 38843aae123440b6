// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { watchSize } from "./watch";

const GAP_PX = 4;
const EDGE_PX = 8;
const LEAST_HEIGHT_PX = 120;
const MOST_HEIGHT_PX = 340;
const FOLLOW_MS = 100;

let made = 0;

/** What stands below a text field, or above it, wherever it is not cut off; its last line is a note. */
export class FieldPopup {
  protected readonly id = `picker-${++made}`;
  protected readonly box = document.createElement("div");
  private readonly note = document.createElement("p");
  private readonly closed = new AbortController();
  private place = "";

  constructor(
    protected readonly input: HTMLInputElement,
    private readonly widthPx: number,
  ) {
    this.box.className = "picker";
    this.note.id = `${this.id}-note`;
    this.note.setAttribute("role", "status");
    this.note.hidden = true;
    this.box.append(this.note);
    // Above everything else, and not cut off by what scrolls around the field.
    this.box.popover = "manual";
    // The field keeps the focus.
    this.box.addEventListener("mousedown", (event) => event.preventDefault());
    input.after(this.box);
    this.box.showPopover();
    this.follow();
  }

  /** Says something about the text of the field; nothing where `text` is empty. */
  say(text: string, isProblem: boolean): void {
    this.note.textContent = text;
    this.note.hidden = text === "";
    this.note.classList.toggle("problem", isProblem);
    this.box.hidden = text === "" && this.box.childElementCount === 1;
    if (text === "") this.input.removeAttribute("aria-describedby");
    else this.input.setAttribute("aria-describedby", this.note.id);
  }

  /** Puts something above the note. */
  hold(content: HTMLElement): void {
    this.note.before(content);
    this.box.hidden = false;
  }

  dispose(): void {
    this.closed.abort();
    this.box.remove();
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

  protected settle(): void {
    const field = this.input.getBoundingClientRect();
    const { width, height } = visualViewport ?? { width: innerWidth, height: innerHeight };
    const below = height - field.bottom - GAP_PX - EDGE_PX;
    const above = field.top - GAP_PX - EDGE_PX;
    const isBelow = below >= Math.min(MOST_HEIGHT_PX, this.box.scrollHeight) || below >= above;
    const room = Math.max(Math.min(isBelow ? below : above, MOST_HEIGHT_PX), LEAST_HEIGHT_PX);
    const wide = Math.min(Math.max(this.widthPx, field.width), width - 2 * EDGE_PX);
    const left = Math.max(Math.min(field.left, width - wide - EDGE_PX), EDGE_PX);
    const place = `left:${left}px;width:${wide}px;max-height:${room}px;${
      isBelow ? `top:${field.bottom + GAP_PX}px` : `bottom:${innerHeight - field.top + GAP_PX}px`
    }`;
    if (place === this.place) return;
    this.place = place;
    this.box.style.cssText = place;
  }
}
