// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { sentence } from "../ui/numbers";
import type { Draft, Edit, Problem, ProfileTable, Routes } from "./types";

/** What the server refused, or that it did not answer (status 0). */
export class ApiError extends Error {
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

/** The calls of the server; each fails with an ApiError. */
export class Api {
  /** What the server answers on a route; `how` says what ends it, or lets it outlive the page. */
  ask<R extends keyof Routes>(
    route: R,
    asked: Routes[R]["asked"],
    how: { signal?: AbortSignal; keepalive?: true } = {},
  ): Answer<R> {
    return call(route, asked, how);
  }

  project(): Answer<"GET /api/project"> {
    return call("GET /api/project", null);
  }

  read(name: string): Answer<"GET /api/file"> {
    return call("GET /api/file", null, { query: `?name=${encodeURIComponent(name)}` });
  }

  /** What tells whether a file was changed by somebody else. */
  fileState(name: string): Answer<"GET /api/file/state"> {
    return call("GET /api/file/state", null, { query: `?name=${encodeURIComponent(name)}` });
  }

  /** `byItself` is whether nobody asked for it. */
  save(name: string, text: string, baseHash: string | null, byItself = false): Answer<"PUT /api/file"> {
    return call("PUT /api/file", { name, text, base_hash: baseHash, by_itself: byItself });
  }

  /** What was saved of a rule file, the newest first. */
  versions(name: string): Answer<"GET /api/versions"> {
    return call("GET /api/versions", null, { query: `?name=${encodeURIComponent(name)}` });
  }

  document(rules: Rules): Answer<"POST /api/document"> {
    return call("POST /api/document", rules);
  }

  /** Does edits in their order, each in the text that those before it made; all of them or none. */
  edit(rules: Rules, edits: Edit[]): Answer<"POST /api/edit"> {
    return call("POST /api/edit", { ...rules, edits });
  }

  vocabulary(text: string, profileText: string | null): Answer<"POST /api/vocabulary"> {
    return call("POST /api/vocabulary", { text, profile_text: profileText });
  }

  parseProfile(name: string, text: string): Answer<"POST /api/profile/parse"> {
    return call("POST /api/profile/parse", { name, text });
  }

  /** The profile that somebody chose for the rules, else the one that they are most likely meant for. */
  profileFor({ name, text }: Rules): Answer<"POST /api/profile/for"> {
    return call("POST /api/profile/for", { name, text });
  }

  /** Remembers the profile of a rule file, null for none, for everybody who opens the project. */
  chooseProfile(name: string, profile: string | null): Answer<"PUT /api/profile/for"> {
    // Who chooses and leaves at once has chosen, too.
    return call("PUT /api/profile/for", { name, profile }, { keepalive: true });
  }

  writeProfile(name: string, table: ProfileTable, baseText: string): Answer<"POST /api/profile/write"> {
    return call("POST /api/profile/write", { ...table, name, base_text: baseText });
  }

  /** Copies a file into the project as a new recording. */
  addRecording(file: File): Answer<"PUT /api/recording"> {
    return call("PUT /api/recording", null, { query: `?name=${encodeURIComponent(file.name)}`, file });
  }

  measureProfile(bag: string): Answer<"POST /api/profile/measure"> {
    return call("POST /api/profile/measure", { bag });
  }

  zones(rules: Rules): Answer<"POST /api/zones"> {
    return call("POST /api/zones", rules);
  }

  backgrounds(): Answer<"GET /api/backgrounds"> {
    return call("GET /api/backgrounds", null);
  }

  /** What would change on a robot that gets these rules. */
  previewPush(rules: Rules, node: string): Answer<"POST /api/push/preview"> {
    return call("POST /api/push/preview", { ...rules, node });
  }

  /** Lets a robot try these rules. */
  push(rules: Rules, node: string): Answer<"POST /api/push"> {
    return call("POST /api/push", { ...rules, node });
  }

  /** The incidents that are being kept, and those that were since. */
  keeps(): Answer<"GET /api/try/keeps"> {
    return call("GET /api/try/keeps", null);
  }

  /** What rules recorded, the newest first. */
  incidents(): Answer<"GET /api/incidents"> {
    return call("GET /api/incidents", null);
  }

  /** What the robots on the link recorded. */
  robotIncidents(): Answer<"GET /api/robot-incidents"> {
    return call("GET /api/robot-incidents", null);
  }

  /** What is being fetched from robots, and how far it is. */
  fetches(): Answer<"GET /api/robot-incidents/fetches"> {
    return call("GET /api/robot-incidents/fetches", null);
  }

  /** Six levels for a source of which only the rate is known. */
  levels(sourceHz: number): Answer<"POST /api/profile/levels"> {
    return call("POST /api/profile/levels", { source_hz: sourceHz });
  }
}

async function call<R extends keyof Routes>(
  route: R,
  asked: Routes[R]["asked"],
  { query = "", file, ...how }: { query?: string; file?: File; signal?: AbortSignal; keepalive?: true } = {},
): Answer<R> {
  const [method, path] = route.split(" ") as [string, string];
  const response = await send(method, path + query, file ?? asked ?? undefined, how);
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

/** What the server says when it refuses; anything else is a bug and goes on. */
export function refusal(error: unknown): string {
  if (!(error instanceof ApiError)) throw error;
  return error.message;
}

/** Does work; what the server refused of it, empty where it is done. */
export async function refusalOf(work: () => Promise<unknown>): Promise<string> {
  try {
    await work();
    return "";
  } catch (error) {
    return refusal(error);
  }
}
