// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { vi } from "vitest";
import { Api } from "../../src/api/client";
import type { FileDraft, ProfileRow } from "../../src/api/types";
import { type DraftStorage, LocalDrafts } from "../../src/state/drafts";
import { ProfileEditor } from "../../src/state/profile_editor";
import { RuleEditor } from "../../src/state/rule_editor";

/** What was asked, from the query and the body. */
type Asked = Record<string, string>;
/** What a server answers on each route; a Response as it is. */
export type Answers = Record<string, (asked: Asked) => unknown>;

/** Answers like the server on these routes, and `{}` on others. */
export function serve(answers: Answers): void {
  vi.stubGlobal("window", globalThis);
  vi.stubGlobal("addEventListener", () => undefined);
  vi.stubGlobal("fetch", async (path: string, { method, body }: RequestInit) => {
    const { pathname, searchParams } = new URL(path, "http://localhost");
    const asked = { ...Object.fromEntries(searchParams), ...(body ? JSON.parse(String(body)) : {}) };
    const answer = await answers[`${method} ${pathname}`]?.(asked);
    return answer instanceof Response ? answer : new Response(JSON.stringify(answer ?? {}));
  });
}

/** An answer that begins well and breaks off, as where the server ends meanwhile. */
export function brokenOff(): Response {
  return new Response(new ReadableStream({ start: (body) => body.error(new TypeError("network error")) }));
}

export function refused(status: number): Response {
  const error = { message: `refused with ${status}`, place: "", remedy: "", findings: [] };
  return new Response(JSON.stringify({ error }), { status });
}

/** One file on the server's disk, null where none is, with its draft and what was given up of it. */
export interface Disk {
  text: string | null;
  draft?: FileDraft | null;
  discarded?: string[];
}

/** How a server reads and saves the only file that it has. */
export function fileAnswers(name: string, disk: Disk): Answers {
  const hashOf = (text: string | null) => (text === null ? null : `hash of ${text}`);
  const isThere = (asked: Asked) => asked.name === name && disk.text !== null;
  return {
    "GET /api/file/state": (asked) => ({ hash: isThere(asked) ? hashOf(disk.text) : null }),
    "GET /api/file": (asked) => (isThere(asked) ? { name, text: disk.text, hash: hashOf(disk.text) } : refused(404)),
    "PUT /api/file": ({ text = "", base_hash, draft_ids }) => {
      if (base_hash !== hashOf(disk.text) || !isKnown(disk, draft_ids)) return refused(409);
      Object.assign(disk, { text, draft: null });
      return { hash: hashOf(text) };
    },
    "GET /api/draft": (asked) => ({ draft: (asked.name === name && disk.draft) || null }),
    "PUT /api/draft": ({ id = "", known_ids, draft, discarded }) => {
      if (typeof discarded === "string") disk.discarded = [...(disk.discarded ?? []), discarded];
      if (draft !== null && !isKnown(disk, known_ids)) return refused(409);
      if (draft !== null) disk.draft = { ...(draft as unknown as FileDraft), id, changed_at_ms: Date.now() };
      else if (isKnown(disk, known_ids)) disk.draft = null;
      return { draft: disk.draft };
    },
  };
}

/** Whether a page that knows drafts of these ids knows the one that there is. */
function isKnown({ draft }: Disk, ids: unknown): boolean {
  return !draft || (ids as string[]).includes(draft.id);
}

/** A browser's storage. */
export function storage(): DraftStorage {
  const entries = new Map<string, string>();
  return {
    get length() {
      return entries.size;
    },
    key: (index) => [...entries.keys()][index] ?? null,
    getItem: (key) => entries.get(key) ?? null,
    removeItem: (key) => void entries.delete(key),
    setItem: (key, value) => void entries.set(key, value),
  };
}

let pages = 0;

/** What a page keeps in a browser; the server takes drafts where `canSend`. */
export const draftsIn = (kept = storage(), canSend = () => true) =>
  new LocalDrafts(kept, "shelf", `page ${pages++}`, canSend);

/** A rule file that is open, of a server that answers `more` as well. */
export async function openRules(disk: Disk, more: Answers = {}, drafts = draftsIn()): Promise<RuleEditor> {
  serve({
    ...fileAnswers("a.adirf", disk),
    "POST /api/document": () => ({ collections: [], findings: [], parses: true }),
    "POST /api/profile/for": () => ({ name: null, gone: null }),
    ...more,
  });
  const editor = new RuleEditor(new Api(), "a.adirf", drafts);
  await editor.open();
  return editor;
}

/** A table that is open, and kept as JSON by a server that answers `more` as well. */
export async function openTable(disk: Disk, more: Answers = {}, drafts = draftsIn()): Promise<ProfileEditor> {
  const written = (rows: ProfileRow[]) => rows.map(({ topic, message_kb }) => ({ topic, message_kb }));
  serve({
    ...fileAnswers("lte.toml", disk),
    "POST /api/profile/parse": ({ text = "" }) => ({ rows: JSON.parse(text), budget_kb_per_s: 100 }),
    "POST /api/profile/write": ({ rows }) => ({ text: JSON.stringify(written(rows as unknown as ProfileRow[])) }),
    "POST /api/profile/check": () => ({ problem: "" }),
    ...more,
  });
  const editor = new ProfileEditor(new Api(), "lte.toml", drafts);
  await editor.open(disk.text !== null);
  return editor;
}

/** Types a message's size into a row. */
export function typeSize(editor: ProfileEditor, at: number, message_kb: string): void {
  const typed = editor.rows.value[at];
  if (!typed) throw new Error("the table has this row");
  editor.change(typed.key, { message_kb });
}
