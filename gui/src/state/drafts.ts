// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Unsaved } from "../api/types";

/** What was not saved of a file, in this browser until the server has it. */
export interface LocalDraft extends Unsaved {
  /** The drafts of the server that it takes the place of, or may have become. */
  knownIds: readonly string[];
  /** When it was changed last, in milliseconds since 1970. */
  changedMs: number;
}

/** What of the browser's storage drafts need. */
export type DraftStorage = Pick<Storage, "getItem" | "setItem" | "removeItem" | "key" | "length">;

/** Said where neither the server nor the browser keeps a draft. */
export const NO_ROOM = "This browser has no room for drafts: what is not saved is lost with a reload";

const PREFIX = "unsaved";

/** What is not saved of a project's files and not on the server either: each page writes beside the others. */
export class LocalDrafts {
  /** Whether the browser took the last one. */
  hasRoom = true;
  private counter = 0;

  constructor(
    private readonly storage: DraftStorage,
    readonly project: string,
    private readonly page: string,
    /** Whether the server takes drafts now. */
    readonly canSend = () => true,
  ) {}

  /** What no other draft of any page is called. */
  newId(): string {
    return `${this.page} ${this.counter++}`;
  }

  keep(name: string, draft: LocalDraft): void {
    try {
      this.storage.setItem(this.key(name), JSON.stringify(draft));
      this.hasRoom = true;
    } catch {
      this.hasRoom = false;
    }
  }

  drop(name: string): void {
    this.storage.removeItem(this.key(name));
  }

  /** The newest draft of a file, which is this page's from now on. */
  takeOver(name: string): LocalDraft | null {
    const found = this.all().flatMap((each) => (each.name === name ? [{ ...each, draft: this.read(each.key) }] : []));
    const [newest] = found.sort((a, b) => (b.draft?.changedMs ?? 0) - (a.draft?.changedMs ?? 0));
    if (newest === undefined) return null;
    // Kept before the other goes: the browser may end between the two.
    if (newest.draft !== null) this.keep(name, newest.draft);
    if (this.hasRoom && newest.key !== this.key(name)) this.storage.removeItem(newest.key);
    return newest.draft;
  }

  /** The files that have one, of this page or another. */
  names(): string[] {
    return [...new Set(this.all().map(({ name }) => name))].sort();
  }

  private key(name: string): string {
    return JSON.stringify([PREFIX, this.project, name, this.page]);
  }

  private all(): { key: string; name: string }[] {
    const keys = Array.from({ length: this.storage.length }, (_, index) => this.storage.key(index) ?? "");
    return keys.flatMap((key) => {
      const list = parsed<unknown>(key);
      const [prefix, project, name] = Array.isArray(list) ? list : [];
      return prefix === PREFIX && project === this.project && typeof name === "string" ? [{ key, name }] : [];
    });
  }

  private read(key: string): LocalDraft | null {
    const draft = parsed<Partial<LocalDraft>>(this.storage.getItem(key) ?? "");
    const { content, beside, base_hash = null, knownIds = [], changedMs } = draft ?? {};
    if (typeof content !== "string" || typeof beside !== "string" || typeof changedMs !== "number") return null;
    return { content, beside, base_hash, knownIds, changedMs };
  }
}

function parsed<T>(text: string): T | null {
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
