// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { DraftRequest, FileDraft, LastTry, TriedRequest } from "../../src/api/types";
import type { Answered, Asked } from "./answers";

/**
 * In place of the server: the drafts, and what the list of files says of each. Which drafts a page sends depends on how
 * fast it is, so that they are not recorded.
 */
export class PlayedDrafts {
  private readonly drafts = new Map<string, FileDraft>();
  private readonly tries = new Map<string, LastTry>();

  /** Null for what the server answers. */
  answer({ ask, body }: Asked): Answered | null {
    const [route = "", query] = ask.split("?");
    const name = new URLSearchParams(query).get("name") ?? "";
    const json = this.json(route, name, body);
    return json === null ? null : { status: 200, json };
  }

  /** The file was saved, with its draft. */
  saved(name: string): void {
    this.drafts.delete(name);
  }

  private json(route: string, name: string, body: unknown): unknown {
    switch (route) {
      case "GET /api/draft":
        return { draft: this.drafts.get(name) ?? null };
      case "PUT /api/draft": {
        const { name, id, draft } = body as DraftRequest;
        if (draft === null) this.drafts.delete(name);
        else this.drafts.set(name, { ...draft, id, changed_at_ms: Date.now() });
        return { draft: this.drafts.get(name) ?? null };
      }
      case "GET /api/drafts":
        return { drafts: [...this.drafts].map(([name, { changed_at_ms }]) => ({ name, changed_at_ms })) };
      case "GET /api/file/summary":
        return { load: null, last_try: this.tries.get(name) ?? null };
      case "PUT /api/file/tried": {
        const { name, ...said } = body as TriedRequest;
        this.tries.set(name, { ...said, tried_at_ms: Date.now() });
        return this.tries.get(name);
      }
      default:
        return null;
    }
  }
}
