// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { watchSize } from "./watch";

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
  /** What is said of a text that is kept as typed; empty where that is nothing. */
  unknown(): string;
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
    // A topic of which only the beginning is typed is the one that begins so.
    const isHalf = text.startsWith("/") && this.found.filter(({ choice }) => choice.word.startsWith(text)).length === 1;
    const isOpenEnded = this.isTyped && text !== "" && (isHalf || !this.owner.isWhole(text));
    const kept = this.found.findIndex(({ choice }) => choice.word === before);
    const same = this.found.findIndex(({ choice }) => choice.word.toLowerCase() === text.toLowerCase());
    const best = isOpenEnded && this.found[0]?.isByName ? 0 : NONE;
    this.active = same >= 0 ? same : this.isTyped ? best : kept;
    const isOffered = this.found.some(({ choice }) => choice.word === text);
    const asTyped = best === 0 && !isOffered && this.owner.refusal(text) === "" ? text : null;
    const unknown = this.owner.unknown();
    if (asTyped !== null) this.found = [...this.found, asItIs(asTyped, unknown)];
    const refusal = this.isTyped && this.active === NONE ? this.owner.refusal(text) : "";
    const isNew = this.found.length === 0 && text !== "" && this.owner.isWhole(text);
    const note = refusal || (isNew ? `“${text}” is kept as typed${unknown && `: ${unknown}`}` : this.owner.hint);
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

function asItIs(text: string, unknown: string): Found {
  return { choice: { word: text, note: `as typed${unknown && `, ${unknown}`}` }, isByName: true };
}

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

/** Something to pick: the word that is kept, what stands beside it, and what explains it. */
export interface PickerChoice {
  word: string;
  aside?: string;
  note?: string;
}

/** A choice that a typed text could mean; `isByName` where the text is in its word and not only in its note. */
export interface Found {
  choice: PickerChoice;
  isByName: boolean;
}

const BY_NOTE = 4;

/** The choices that a text could mean, the likeliest first; all in their order where nothing is typed. */
export function matching(choices: readonly PickerChoice[], text: string): Found[] {
  const wanted = text.toLowerCase();
  return choices
    .map((choice) => ({ choice, rank: rankOf(choice, wanted) }))
    .filter(({ rank }) => rank <= BY_NOTE)
    .sort((a, b) => a.rank - b.rank)
    .map(({ choice, rank }) => ({ choice, isByName: rank < BY_NOTE }));
}

/** 0 for the word itself, then its beginning or end, a part's beginning, within the word, within the note. */
function rankOf({ word, note }: PickerChoice, wanted: string): number {
  const name = word.toLowerCase();
  if (wanted === "") return 1;
  const bare = wanted.replace(/^\//, "");
  if (name === wanted || name === `/${bare}`) return 0;
  if (name.startsWith(wanted) || name.startsWith(`/${bare}`) || name.endsWith(`/${bare}`)) return 1;
  if (parts(name).some((part) => part.startsWith(bare)) || name.endsWith(`_${bare}`)) return 2;
  if (name.includes(wanted)) return 3;
  return note?.toLowerCase().includes(wanted) ? BY_NOTE : BY_NOTE + 1;
}

function parts(name: string): string[] {
  return name.split(/[/_.[\]]+/);
}
