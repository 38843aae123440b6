// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { commands } from "vitest/browser";

/** Texts of files by their names; null removes one. */
export type Files = Record<string, string | null>;

/** A request of the page; `body` is what was sent, as JSON or `{base64}`. */
export interface Asked {
  /** Its method and its path with the query, as in `GET /api/file?name=radio.toml`. */
  ask: string;
  body: unknown;
}

/** What a server answers: `json`, or anything of another `type`. */
export interface Answered {
  status: number;
  json?: unknown;
  type?: string;
  base64?: string;
}

interface Step {
  ask?: string;
  body?: string;
  answer?: string;
  files?: Files;
  changes?: true;
}

interface AnswersFile {
  tests: Record<string, { project: string; files: Files; steps: Step[] }>;
  bodies: Record<string, unknown>;
  answers: Record<string, Answered>;
}

/** Whoever answers the page: records, or the real server that is recorded. */
export interface Server {
  answer(asked: Asked): Promise<Answered>;
  /** Writes files as somebody else does. */
  write(files: Files): Promise<void>;
  end(): Promise<void>;
}

/** What a test is called, and what its project holds. */
export interface Named {
  file: string;
  test: string;
  project: string;
  files: Files;
}

export async function serverOf(named: Named): Promise<Server> {
  if (await commands.isRecording()) {
    await commands.recorder("begin", { project: named.project, files: named.files });
    return new RecordedServer(named);
  }
  const text = await commands.recordedAnswers(named.file);
  const file = text === null ? null : (JSON.parse(text) as AnswersFile);
  const test = file?.tests[named.test];
  if (file === null || test === undefined) throw new Error(`No answers of "${named.test}": ${REMEDY}`);
  if (test.project !== named.project || !isSame(test.files, named.files))
    throw new Error(`"${named.test}" was recorded in another project: ${REMEDY}`);
  return new PlayedServer(test.steps, file);
}

const REMEDY = "record it: make page-answers";

class RecordedServer implements Server {
  constructor(private readonly named: Named) {}

  answer(asked: Asked): Promise<Answered> {
    return commands.recorder("ask", asked) as Promise<Answered>;
  }

  async write(files: Files): Promise<void> {
    await commands.recorder("write", { files });
  }

  async end(): Promise<void> {
    await commands.recorder("end", this.named);
  }
}

interface Known {
  /** How many changes came before. */
  stage: number;
  changes: boolean;
  answer: Answered;
  isUsed: boolean;
}

/** Answers each request as it was recorded after as many changes: how often the page looks does not matter. */
class PlayedServer implements Server {
  private stage = 0;
  private readonly known = new Map<string, Known[]>();

  constructor(steps: Step[], { bodies, answers }: AnswersFile) {
    let stage = 0;
    for (const { ask = WRITE, body, answer, files, changes = false } of steps) {
      const key = keyOf(ask, files ?? (body === undefined ? null : bodies[body]));
      const answered = (answer && answers[answer]) || { status: 200, json: null };
      this.known.set(key, [...(this.known.get(key) ?? []), { stage, changes, answer: answered, isUsed: false }]);
      if (changes) stage++;
    }
  }

  async answer({ ask, body }: Asked): Promise<Answered> {
    const known = this.known.get(keyOf(ask, body)) ?? [];
    const found = known[0]?.changes ? known.find(({ isUsed }) => !isUsed) : this.looked(known);
    if (found === undefined) return this.unrecorded(ask, body);
    found.isUsed = true;
    if (found.changes) this.stage++;
    return found.answer;
  }

  async write(files: Files): Promise<void> {
    await this.answer({ ask: WRITE, body: files });
  }

  async end(): Promise<void> {}

  /** What is answered from what was sent alone; anything else must be recorded. */
  private async unrecorded(ask: string, body: unknown): Promise<Answered> {
    const answer = ask.startsWith("POST ") ? await commands.askServer(ask, body) : null;
    if (answer?.status === 200) return answer;
    throw new Error(`${ask} ${JSON.stringify(body)?.slice(0, 1000) ?? ""}: ${REMEDY}`);
  }

  private looked(known: Known[]): Known | undefined {
    const now = known.filter(({ stage }) => stage === this.stage);
    const before = known.filter(({ stage }) => stage <= this.stage);
    // What was asked with its text is answered alike at any time, so that it may come early.
    return now.find(({ isUsed }) => !isUsed) ?? before.at(-1) ?? known[0];
  }
}

const WRITE = "write";

function keyOf(ask: string, body: unknown): string {
  return `${ask} ${JSON.stringify(sorted(body))}`;
}

function isSame(one: unknown, other: unknown): boolean {
  return keyOf("", one) === keyOf("", other);
}

function sorted(value: unknown): unknown {
  if (Array.isArray(value)) return value.map(sorted);
  if (value === null || typeof value !== "object") return value ?? null;
  return Object.fromEntries(
    Object.entries(value)
      .sort(([one], [other]) => (one < other ? -1 : 1))
      .map(([name, each]) => [name, sorted(each)]),
  );
}
