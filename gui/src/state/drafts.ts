// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal } from "@preact/signals";

/** Which kind of file a draft is of. */
export type DraftKind = "rules" | "profile";

/** What was not saved of one file. */
export interface Draft {
  /** What its editor needs to go on, as JSON. */
  content: string;
  /** Of the file that was changed; null where there was none. */
  hash: string | null;
  /** When it was changed last, in milliseconds since 1970. */
  changedMs: number;
}

/** A draft that was restored, as a person is told of it. */
export interface Restored {
  changedMs: number;
  /** Whether the file is another one by now. */
  isContested: boolean;
}

/** What of the browser's storage drafts need. */
export type DraftStorage = Pick<Storage, "getItem" | "setItem" | "removeItem" | "key" | "length">;

/** Said where the browser keeps no draft. */
export const NO_ROOM = "This browser has no room for drafts: what is not saved is lost with a reload";

const PREFIX = "draft";

/**
 * What is not saved of a project's files, kept in this browser.
 *
 * Each tab has drafts of its own, so that two with one file do not write over each other; those of a tab
 * that was closed or crashed are taken over by the next one that opens the file.
 */
export class Drafts {
  /** Whether the browser took the last draft. */
  hasRoom = true;

  constructor(
    private readonly storage: DraftStorage,
    private readonly project: string,
    private readonly tab: string,
    /** The other tabs that are open now. */
    private readonly otherTabs: () => Promise<ReadonlySet<string>>,
  ) {}

  /** Keeps what is not saved; false where the browser has no room for it. */
  keep(kind: DraftKind, name: string, draft: Draft): boolean {
    try {
      this.storage.setItem(this.key(kind, name), JSON.stringify(draft));
      this.hasRoom = true;
    } catch {
      this.hasRoom = false;
    }
    return this.hasRoom;
  }

  drop(kind: DraftKind, name: string): void {
    this.storage.removeItem(this.key(kind, name));
  }

  /** The newest draft of a file that no other tab works on; it is this tab's from now on, and older ones are gone. */
  async takeOver(kind: DraftKind, name: string): Promise<Draft | null> {
    const mine = this.of(kind).filter((each) => each.name === name);
    if (mine.length === 0) return null;
    const others = await this.otherTabs();
    const free = mine.filter(({ tab }) => !others.has(tab)).map(({ key }) => [key, this.read(key)] as const);
    const drafts = free.map(([, draft]) => draft).filter((draft) => draft !== null);
    const newest = drafts.sort((a, b) => b.changedMs - a.changedMs)[0] ?? null;
    // Kept before the others go: the browser may end between the two.
    if (newest !== null && !this.keep(kind, name, newest)) return newest;
    for (const [key] of free) if (key !== this.key(kind, name)) this.storage.removeItem(key);
    return newest;
  }

  /** Whether another tab has a draft of this file, once this tab took over what was free. */
  isElsewhere(kind: DraftKind, name: string): boolean {
    return this.of(kind).some((each) => each.name === name && each.tab !== this.tab);
  }

  /** The files that have drafts, of this tab or another. */
  names(kind: DraftKind): string[] {
    return [...new Set(this.of(kind).map(({ name }) => name))].sort();
  }

  private key(kind: DraftKind, name: string): string {
    return JSON.stringify([PREFIX, this.project, kind, name, this.tab]);
  }

  private of(kind: DraftKind): { key: string; name: string; tab: string }[] {
    const keys = Array.from({ length: this.storage.length }, (_, index) => this.storage.key(index) ?? "");
    return keys.flatMap((key) => {
      const [prefix, project, keyKind, name, tab] = parts(key);
      const isOne = prefix === PREFIX && project === this.project && keyKind === kind && name !== undefined;
      return isOne && tab !== undefined ? [{ key, name, tab }] : [];
    });
  }

  private read(key: string): Draft | null {
    const draft = parsed(this.storage.getItem(key) ?? "") as Partial<Draft> | null;
    if (typeof draft?.content !== "string" || typeof draft.changedMs !== "number") return null;
    return { content: draft.content, hash: draft.hash ?? null, changedMs: draft.changedMs };
  }
}

function parts(key: string): string[] {
  const list = parsed(key);
  return Array.isArray(list) && list.every((part) => typeof part === "string") ? list : [];
}

function parsed(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

/** The browser's storage; where it lets nobody in, one that is empty and takes nothing. */
export function browserStorage(): DraftStorage {
  try {
    return localStorage;
  } catch {
    return { length: 0, key: () => null, getItem: () => null, removeItem: () => undefined, setItem: refuse };
  }
}

function refuse(): never {
  throw new Error("no storage");
}

/** A draft is written no more often than this: writing a long file takes longer than drawing a letter. */
const WRITE_AFTER_MS = 400;

/** A file that is being changed, as its draft needs it. */
interface Unsaved {
  readonly name: string;
  readonly restored: Signal<Restored | null>;
  readonly message: Signal<string>;
  /** Makes the draft of now, null while the file holds all; reads each signal that changes the draft. */
  draft(): (() => Draft) | null;
}

/** Keeps what is not saved of a file in this browser, a moment after it changed or when the page is left. */
export function storeDraft(drafts: Drafts, kind: DraftKind, file: Unsaved): void {
  let due: { write: () => void; timer: number } | null = null;
  const settle = () => {
    if (due === null) return;
    clearTimeout(due.timer);
    const { write } = due;
    due = null;
    write();
  };
  // A key that comes meanwhile is more urgent.
  const settleIdle = () => {
    if ("requestIdleCallback" in globalThis) requestIdleCallback(settle, { timeout: WRITE_AFTER_MS });
    else settle();
  };
  effect(() => {
    const draft = file.draft();
    const write = () => {
      if (draft !== null && !drafts.keep(kind, file.name, draft())) file.message.value = NO_ROOM;
    };
    if (draft !== null) {
      due = { write, timer: due?.timer ?? setTimeout(settleIdle, WRITE_AFTER_MS) };
      return;
    }
    if (due !== null) clearTimeout(due.timer);
    due = null;
    drafts.drop(kind, file.name);
    file.restored.value = null;
  });
  addEventListener("pagehide", settle);
}

/** How long tabs have to answer; one that is closed cannot. */
const ANSWER_WITHIN_MS = 150;
/** How long one has that is known to be open, and may be busy. */
const OPEN_ANSWERS_WITHIN_MS = 3000;
const LOCK = "ruler-tab ";

type Call = { kind: "who" } | { kind: "here"; tab: string };

/** Which tabs have a page of this server open. */
export class OpenTabs {
  private readonly channel = new BroadcastChannel("ruler-tabs");
  private readonly heard = new Set<string>();

  constructor(readonly own: string) {
    this.channel.onmessage = ({ data }: MessageEvent<Call>) => {
      if (data.kind === "here") this.heard.add(data.tab);
      else this.say({ kind: "here", tab: this.own });
    };
    // Held until the tab is closed or crashes; a browser has locks only where it trusts the address and keeps anything.
    void navigator.locks?.request(LOCK + own, () => new Promise(() => undefined)).catch(() => undefined);
  }

  /** The other tabs that answer now. */
  async others(): Promise<ReadonlySet<string>> {
    this.heard.clear();
    this.say({ kind: "who" });
    const askedMs = performance.now();
    do await new Promise((done) => setTimeout(done, ANSWER_WITHIN_MS));
    while (performance.now() - askedMs < OPEN_ANSWERS_WITHIN_MS && (await this.isAnyAwaited()));
    return new Set(this.heard);
  }

  /** Whether another tab is open and has not answered yet. */
  private async isAnyAwaited(): Promise<boolean> {
    const locks = (await navigator.locks?.query())?.held ?? [];
    const tabs = locks.flatMap(({ name = "" }) => (name.startsWith(LOCK) ? [name.slice(LOCK.length)] : []));
    return tabs.some((tab) => tab !== this.own && !this.heard.has(tab));
  }

  private say(call: Call): void {
    this.channel.postMessage(call);
  }
}
