// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { PushPreview, Staged } from "./live_types";
import type {
  Edit,
  EditAnswer,
  FileText,
  OptimizeAnswer,
  Problem,
  ProfileTable,
  Project,
  RuleDocument,
  Vocabulary,
} from "./types";
import type { ImportChoice, ImportPreview, TextFile } from "./sharing_types";
import type { Curve } from "./curve_types";
import type { TryAnswer } from "./try_types";
import type { Background, BackgroundChoice, CoverAnswer, DrivenPath, ZonesAnswer } from "./zone_types";

/** What the server refused, or that it did not answer (status 0). */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Problem,
  ) {
    super([problem.message, problem.remedy].filter(Boolean).join(". "));
  }
}

const UNREACHABLE: Problem = {
  message: "The Ruler's server does not answer",
  place: "",
  remedy: "Is 'testudo ruler' still running in its terminal? Your text is kept on this page",
  findings: [],
};

/** A rule file as every call names it. */
export interface Rules {
  text: string;
  name: string;
  profile_text: string | null;
}

/** The calls of the server; each fails with an ApiError. */
export class Api {
  project(): Promise<Project> {
    return call("GET", "/api/project");
  }

  read(name: string): Promise<FileText> {
    return call("GET", `/api/file?name=${encodeURIComponent(name)}`);
  }

  save(name: string, text: string, baseHash: string | null): Promise<{ hash: string }> {
    return call("PUT", "/api/file", { name, text, base_hash: baseHash });
  }

  document(rules: Rules): Promise<RuleDocument> {
    return call("POST", "/api/document", rules);
  }

  edit(rules: Rules, edit: Edit): Promise<EditAnswer> {
    return call("POST", "/api/edit", { ...rules, edit });
  }

  format(rules: Rules): Promise<{ text: string }> {
    return call("POST", "/api/format", rules);
  }

  fix(rules: Rules, index: number): Promise<EditAnswer> {
    return call("POST", "/api/fix", { ...rules, index });
  }

  vocabulary(text: string, profileText: string | null): Promise<Vocabulary> {
    return call("POST", "/api/vocabulary", { text, profile_text: profileText });
  }

  parseProfile(name: string, text: string): Promise<ProfileTable> {
    return call("POST", "/api/profile/parse", { name, text });
  }

  writeProfile(name: string, table: ProfileTable, baseText: string): Promise<{ text: string }> {
    return call("POST", "/api/profile/write", { ...table, name, base_text: baseText });
  }

  /** Why a table could not be written; empty if it could. */
  checkProfile(name: string, table: ProfileTable, baseText: string): Promise<{ problem: string }> {
    return call("POST", "/api/profile/check", { ...table, name, base_text: baseText });
  }

  measureProfile(bag: string): Promise<{ text: string }> {
    return call("POST", "/api/profile/measure", { bag });
  }

  exportRules(rules: Rules, ids: readonly string[]): Promise<{ text: string }> {
    return call("POST", "/api/export", { text: rules.text, name: rules.name, ids });
  }

  importPreview(rules: Rules, other: TextFile): Promise<ImportPreview> {
    return call("POST", "/api/import/preview", {
      text: rules.text,
      name: rules.name,
      other_text: other.text,
      other_name: other.name,
    });
  }

  importRules(rules: Rules, otherText: string, choice: ImportChoice): Promise<EditAnswer> {
    return call("POST", "/api/import", { ...rules, other_text: otherText, ...choice });
  }

  zones(rules: Rules): Promise<ZonesAnswer> {
    return call("POST", "/api/zones", rules);
  }

  /** The rectangles that cover a polygon. */
  cover(corners: readonly (readonly [number, number])[], maxRectangles: number): Promise<CoverAnswer> {
    return call("POST", "/api/zones/cover", { corners, max_rectangles: maxRectangles });
  }

  backgrounds(): Promise<{ choices: BackgroundChoice[] }> {
    return call("GET", "/api/backgrounds");
  }

  background(kind: "map" | "image", name: string): Promise<Background> {
    return call("POST", "/api/background", { kind, name });
  }

  drivenPath(bag: string): Promise<DrivenPath> {
    return call("POST", "/api/background/path", { bag });
  }

  /** Measures what a robot publishes now, for so many seconds. */
  measureLive(seconds: number): Promise<{ text: string }> {
    return call("POST", "/api/profile/measure-live", { seconds });
  }

  /** What would change on a robot that gets these rules. */
  previewPush(rules: Rules, node: string): Promise<PushPreview> {
    return call("POST", "/api/push/preview", { ...rules, node });
  }

  /** Lets a robot try these rules. */
  push(rules: Rules, node: string): Promise<Staged> {
    return call("POST", "/api/push", { ...rules, node });
  }

  /** Lets a robot keep the rules that it tries. */
  confirmPush(node: string, hash: string): Promise<unknown> {
    return call("POST", "/api/push/confirm", { node, hash });
  }

  optimize(rules: Rules): Promise<OptimizeAnswer> {
    return call("POST", "/api/optimize", rules);
  }

  tryOnBag(rules: Rules, bag: string, run: string, signal: AbortSignal): Promise<TryAnswer> {
    return call("POST", "/api/try", { ...rules, bag, run }, signal);
  }

  curve(bag: string, topic: string, run: string, signal: AbortSignal): Promise<Curve> {
    return call("POST", "/api/profile/curve", { bag, topic, run }, signal);
  }

  /** Six levels for a source of which only the rate is known. */
  levels(sourceHz: number): Promise<{ tiers_hz: number[] }> {
    return call("POST", "/api/profile/levels", { source_hz: sourceHz });
  }
}

async function call<T>(method: string, path: string, body?: unknown, signal?: AbortSignal): Promise<T> {
  const response = await send(method, path, body, signal);
  const answer: unknown = await response.json().catch(() => null);
  if (!response.ok) {
    const problem = (answer as { error?: Problem } | null)?.error;
    throw new ApiError(response.status, problem ?? { ...UNREACHABLE, message: `${path}: ${response.statusText}` });
  }
  return answer as T;
}

async function send(method: string, path: string, body: unknown, signal?: AbortSignal): Promise<Response> {
  const init: RequestInit = { method };
  if (signal) init.signal = signal;
  if (body !== undefined) {
    init.body = JSON.stringify(body);
    init.headers = { "Content-Type": "application/json" };
  }
  try {
    return await fetch(path, init);
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new ApiError(0, UNREACHABLE);
  }
}
