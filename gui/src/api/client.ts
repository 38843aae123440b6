// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { sentence } from "../ui/numbers";
import type { Condition, Draft, Edit, Problem, ProfileEntry, ProfileTable, Routes } from "./types";

/** What the server refused, or that it did not answer (status 0). */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Problem,
  ) {
    super([problem.message, problem.remedy].filter(Boolean).map(sentence).join(". "));
  }
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

/** The rules of a try, and the recording. */
interface Tried {
  rules: Rules;
  bag: string;
}

/** A text and what its file is called. */
export interface TextFile {
  name: string;
  text: string;
}

/** Which statements of another text come in, and which of them replace one of the same name. */
interface ImportChoice {
  ids: string[];
  replace_ids: string[];
}

type Answer<R extends keyof Routes> = Promise<Routes[R]["answered"]>;

/** The calls of the server; each fails with an ApiError. */
export class Api {
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

  /** Calls a file otherwise; `hash` is what the page knows to be in it. */
  rename(name: string, newName: string, hash: string): Answer<"POST /api/file/rename"> {
    return call("POST /api/file/rename", { name, new_name: newName, base_hash: hash });
  }

  remove(name: string, hash: string): Answer<"POST /api/file/delete"> {
    return call("POST /api/file/delete", { name, base_hash: hash });
  }

  /** Whether changes are saved without being asked, for everybody who opens the project. */
  setSavesByItself(savesByItself: boolean): Answer<"PUT /api/project/settings"> {
    return call("PUT /api/project/settings", { saves_by_itself: savesByItself });
  }

  /** What was saved of a rule file, the newest first. */
  versions(name: string): Answer<"GET /api/versions"> {
    return call("GET /api/versions", null, { query: `?name=${encodeURIComponent(name)}` });
  }

  version(name: string, id: string): Answer<"POST /api/version"> {
    return call("POST /api/version", { name, id });
  }

  /** What a robot does otherwise with the new text of a rule file, in words. */
  difference(oldText: string, newText: string): Answer<"POST /api/difference"> {
    return call("POST /api/difference", { old_text: oldText, new_text: newText });
  }

  document(rules: Rules): Answer<"POST /api/document"> {
    return call("POST /api/document", rules);
  }

  /** Does edits in their order, each in the text that those before it made; all of them or none. */
  edit(rules: Rules, edits: Edit[]): Answer<"POST /api/edit"> {
    return call("POST /api/edit", { ...rules, edits });
  }

  format(rules: Rules): Answer<"POST /api/format"> {
    return call("POST /api/format", rules);
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

  /** A profile with one entry changed: its comments, and all else in it, stay. */
  profileEntry(profile: TextFile, entry: ProfileEntry): Answer<"POST /api/profile/entry"> {
    const { topic, key, value } = entry;
    return call("POST /api/profile/entry", { ...profile, topic, key, value });
  }

  /** Why a table could not be written; empty if it could. */
  checkProfile(name: string, table: ProfileTable, baseText: string): Answer<"POST /api/profile/check"> {
    return call("POST /api/profile/check", { ...table, name, base_text: baseText });
  }

  /** What a recording of the project holds. */
  recording(bag: string): Answer<"POST /api/recording"> {
    return call("POST /api/recording", { bag });
  }

  /** Copies a file into the project as a new recording. */
  addRecording(file: File): Answer<"PUT /api/recording"> {
    return call("PUT /api/recording", null, { query: `?name=${encodeURIComponent(file.name)}`, file });
  }

  measureProfile(bag: string): Answer<"POST /api/profile/measure"> {
    return call("POST /api/profile/measure", { bag });
  }

  exportRules({ text, name }: Rules, ids: string[]): Answer<"POST /api/export"> {
    return call("POST /api/export", { text, name, ids });
  }

  importPreview({ text, name }: Rules, other: TextFile): Answer<"POST /api/import/preview"> {
    return call("POST /api/import/preview", { text, name, other_text: other.text, other_name: other.name });
  }

  importRules(rules: Rules, otherText: string, choice: ImportChoice): Answer<"POST /api/import"> {
    return call("POST /api/import", { ...rules, other_text: otherText, ...choice });
  }

  zones(rules: Rules): Answer<"POST /api/zones"> {
    return call("POST /api/zones", rules);
  }

  /** The rectangles that cover a polygon. */
  cover(corners: [number, number][], maxRectangles: number): Answer<"POST /api/zones/cover"> {
    return call("POST /api/zones/cover", { corners, max_rectangles: maxRectangles });
  }

  backgrounds(): Answer<"GET /api/backgrounds"> {
    return call("GET /api/backgrounds", null);
  }

  background(kind: "map" | "image", name: string): Answer<"POST /api/background"> {
    return call("POST /api/background", { kind, name });
  }

  drivenPath(bag: string): Answer<"POST /api/background/path"> {
    return call("POST /api/background/path", { bag });
  }

  /** Measures what a robot publishes now, for so many seconds. */
  measureLive(seconds: number): Answer<"POST /api/profile/measure-live"> {
    return call("POST /api/profile/measure-live", { seconds });
  }

  /** What was heard of a robot within the last hour. */
  robotHistory(node: string): Answer<"POST /api/robot/history"> {
    return call("POST /api/robot/history", { node });
  }

  /** What the checks of a robot read in its last minutes, and when its rules held. */
  robotChecks(node: string, window_s: number, check: number | null): Answer<"POST /api/robot/checks"> {
    return call("POST /api/robot/checks", { node, window_s, check });
  }

  /** Rules and topic parameters from what a robot relays now. */
  robotStart(node: string): Answer<"POST /api/robot/start"> {
    return call("POST /api/robot/start", { node });
  }

  /** What would change on a robot that gets these rules. */
  previewPush(rules: Rules, node: string): Answer<"POST /api/push/preview"> {
    return call("POST /api/push/preview", { ...rules, node });
  }

  /** Lets a robot try these rules. */
  push(rules: Rules, node: string): Answer<"POST /api/push"> {
    return call("POST /api/push", { ...rules, node });
  }

  /** Lets a robot keep the rules that it tries. */
  confirmPush(node: string, hash: string): Answer<"POST /api/push/confirm"> {
    return call("POST /api/push/confirm", { node, hash });
  }

  /** How long the rules last that a robot keeps, and whether they can be written to its file. */
  keptRules(node: string): Answer<"POST /api/push/lasting"> {
    return call("POST /api/push/lasting", { node });
  }

  /** Writes the rules that a robot keeps to its file. */
  writeKept(node: string, hash: string): Answer<"POST /api/push/write"> {
    return call("POST /api/push/write", { node, hash });
  }

  optimize(rules: Rules): Answer<"POST /api/optimize"> {
    return call("POST /api/optimize", rules);
  }

  tryOnBag(rules: Rules, bag: string, run: string, signal: AbortSignal): Answer<"POST /api/try"> {
    return call("POST /api/try", { ...rules, bag, run }, { signal });
  }

  /** What a check reads over a recording, and when it holds. */
  checkCourse(
    asked: { bag: string; condition: Condition; profile_text: string | null },
    run: string,
    signal: AbortSignal,
  ): Answer<"POST /api/check/course"> {
    return call("POST /api/check/course", { ...asked, run }, { signal });
  }

  /** Begins to write an incident that a try showed into the project. */
  keepIncident(tried: Tried, incident: { number: number; run: string; title: string }): Answer<"POST /api/try/keep"> {
    return call("POST /api/try/keep", { ...tried.rules, bag: tried.bag, ...incident });
  }

  /** The incidents that are being kept, and those that were since. */
  keeps(): Answer<"GET /api/try/keeps"> {
    return call("GET /api/try/keeps", null);
  }

  endKeeping(run: string): Answer<"POST /api/try/keep/cancel"> {
    return call("POST /api/try/keep/cancel", { run });
  }

  curve(bag: string, topic: string, run: string, signal: AbortSignal): Answer<"POST /api/profile/curve"> {
    return call("POST /api/profile/curve", { bag, topic, run }, { signal });
  }

  accuracy(bag: string, topic: string, run: string, signal: AbortSignal): Answer<"POST /api/profile/accuracy"> {
    return call("POST /api/profile/accuracy", { bag, topic, run }, { signal });
  }

  /** What rules recorded, the newest first. */
  incidents(): Answer<"GET /api/incidents"> {
    return call("GET /api/incidents", null);
  }

  /** What an incident holds; from now on somebody has read it. */
  incident(name: string): Answer<"POST /api/incident"> {
    return call("POST /api/incident", { name });
  }

  incidentCourse(name: string, run: string, signal: AbortSignal): Answer<"POST /api/incident/course"> {
    return call("POST /api/incident/course", { name, run }, { signal });
  }

  /** Deletes an incident; what is left. */
  deleteIncident(name: string): Answer<"POST /api/incident/delete"> {
    return call("POST /api/incident/delete", { name });
  }

  /** What the robots on the link recorded. */
  robotIncidents(): Answer<"GET /api/robot-incidents"> {
    return call("GET /api/robot-incidents", null);
  }

  /** What is being fetched from robots, and how far it is. */
  fetches(): Answer<"GET /api/robot-incidents/fetches"> {
    return call("GET /api/robot-incidents/fetches", null);
  }

  fetchIncident(robot: string, name: string): Answer<"POST /api/robot-incidents/fetch"> {
    return call("POST /api/robot-incidents/fetch", { robot, name });
  }

  cancelFetch(robot: string, name: string): Answer<"POST /api/robot-incidents/cancel"> {
    return call("POST /api/robot-incidents/cancel", { robot, name });
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
  const answer: unknown = await response.json().catch(() => null);
  if (!response.ok) {
    const problem = (answer as { error?: Problem } | null)?.error;
    throw new ApiError(response.status, problem ?? { ...UNREACHABLE, message: `${path}: ${response.statusText}` });
  }
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
