// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { sentence } from "../ui/numbers";
import type { Draft, Problem, Routes } from "./types";

/** What cannot be done, in words for a person. */
export class Refused extends Error {}

/** What the server refused, or that it did not answer (status 0). */
export class ApiError extends Refused {
  constructor(
    readonly status: number,
    readonly problem: Problem,
  ) {
    super(problemWords(problem));
  }
}

/** Cause and remedy as sentences. */
export function problemWords({ message, remedy }: Pick<Problem, "message" | "remedy">): string {
  return [message, remedy].filter(Boolean).map(sentence).join(". ");
}

const UNREACHABLE: Problem = {
  message: "The Ruler's server does not answer",
  place: "",
  remedy:
    "Is 'testudo ruler' still running in its terminal? What you typed is kept on this page, and blocks stay as they are",
  findings: [],
};

/** A rule file as every call names it. */
export type Rules = Required<Pick<Draft, "text" | "name" | "profile_text">> & Pick<Draft, "profile_name">;

/** A text and what its file is called. */
export interface TextFile {
  name: string;
  text: string;
}

type Answer<R extends keyof Routes> = Promise<Routes[R]["answered"]>;

/** The file in the address of a call, one to send as it is, and what ends the call or lets it outlive the page. */
interface About {
  name?: string;
  file?: File;
  signal?: AbortSignal;
  keepalive?: true;
}

/** The calls of the server; each fails with an ApiError. */
export class Api {
  /** What the server answers on a route, for the file of a `name` where it is about one. */
  async ask<R extends keyof Routes>(route: R, asked: Routes[R]["asked"], about: About = {}): Answer<R> {
    const { name, file, ...how } = about;
    const [method, path] = route.split(" ") as [string, string];
    const address = name === undefined ? path : `${path}?name=${encodeURIComponent(name)}`;
    const response = await send(method, address, file ?? asked ?? undefined, how);
    const answer: unknown = await response.json().catch((error: unknown) => {
      if (how.signal?.aborted) throw error;
      return undefined;
    });
    if (!response.ok) {
      const problem = (answer as { error?: Problem } | null)?.error;
      throw new ApiError(response.status, problem ?? { ...UNREACHABLE, message: `${path}: ${response.statusText}` });
    }
    // It broke off, as where the server ended meanwhile or the network changed.
    if (answer === undefined) throw new ApiError(0, UNREACHABLE);
    return answer as Routes[R]["answered"];
  }

  /** Why there is nothing to show at an address, in words; empty where there is. */
  async problemAt(address: string): Promise<string> {
    return refusalOf(async () => {
      const response = await send("GET", address, undefined, {});
      if (!response.ok) throw new ApiError(response.status, (await response.json()).error);
    });
  }

  project(): Answer<"GET /api/project"> {
    return this.ask("GET /api/project", null);
  }

  read(name: string): Answer<"GET /api/file"> {
    return this.ask("GET /api/file", null, { name });
  }

  /** What tells whether a file was changed by somebody else. */
  fileState(name: string): Answer<"GET /api/file/state"> {
    return this.ask("GET /api/file/state", null, { name });
  }

  /** Writes a file in the place of the one of this hash and of these drafts. */
  save(name: string, text: string, baseHash: string | null, draftIds: readonly string[] = []): Answer<"PUT /api/file"> {
    return this.ask("PUT /api/file", { name, text, base_hash: baseHash, draft_ids: [...draftIds] });
  }

  /** What is not saved of a file. */
  draft(name: string): Answer<"GET /api/draft"> {
    return this.ask("GET /api/draft", null, { name });
  }

  /** What was saved of a rule file, the newest first. */
  versions(name: string): Answer<"GET /api/versions"> {
    return this.ask("GET /api/versions", null, { name });
  }

  /** The profile that somebody chose for the rules, else the one that they are most likely meant for. */
  profileFor({ name, text }: Rules): Answer<"POST /api/profile/for"> {
    return this.ask("POST /api/profile/for", { name, text });
  }

  /** Remembers the profile of a rule file, null for none, for everybody who opens the project. */
  chooseProfile(name: string, profile: string | null): Answer<"PUT /api/profile/for"> {
    // Who chooses and leaves at once has chosen, too.
    return this.ask("PUT /api/profile/for", { name, profile }, { keepalive: true });
  }

  /** Copies a file into the project as a new recording. */
  addRecording(file: File): Answer<"PUT /api/recording"> {
    return this.ask("PUT /api/recording", null, { name: file.name, file });
  }

  /** Lets a robot try these rules. */
  push(rules: Rules, node: string): Answer<"POST /api/push"> {
    return this.ask("POST /api/push", { ...rules, node });
  }
}

async function send(method: string, path: string, body: unknown, how: RequestInit): Promise<Response> {
  const init: RequestInit = { ...how, method };
  if (body instanceof File) {
    init.body = body;
    init.headers = { "Content-Type": "application/octet-stream" };
  } else if (body !== undefined) {
    init.body = JSON.stringify(body);
    init.headers = { "Content-Type": "application/json" };
  }
  try {
    return await fetch(path, init);
  } catch (error) {
    if (how.signal?.aborted) throw error;
    throw new ApiError(0, UNREACHABLE);
  }
}

/** Why something is refused, in words; anything else is a bug and goes on. */
export function refusal(error: unknown): string {
  if (!(error instanceof Refused)) throw error;
  return error.message;
}

/** Does work; why it was refused, empty where it is done. */
export async function refusalOf(work: () => Promise<unknown>): Promise<string> {
  try {
    await work();
    return "";
  } catch (error) {
    return refusal(error);
  }
}
