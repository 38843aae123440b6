// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { signal } from "@preact/signals";
import type { Api, Rules } from "../api/client";
import type { Action, CheckCondition, Condition, RuleDocument, Statement, Vocabulary } from "../api/types";

/** Every topic that the rules set, bound, record or check. */
export function topicsIn(document: Pick<RuleDocument, "collections">): ReadonlySet<string> {
  const topics = new Set<string>();
  for (const { statements } of document.collections) {
    for (const statement of statements) {
      if (statement.kind === "raw") continue;
      if (statement.kind !== "rule") topics.add(statement.topic);
      else {
        for (const { topic } of checksOf(statement.condition)) topics.add(topic);
        for (const action of [...statement.then, ...statement.else]) {
          for (const topic of topicsOf(action)) topics.add(topic);
        }
      }
    }
  }
  return topics;
}

function topicsOf(action: Action): readonly string[] {
  switch (action.kind) {
    case "set":
      return action.margin ? [action.topic, action.margin.topic] : [action.topic];
    case "within":
      return [action.topic];
    case "record":
      return action.topics;
    default:
      return [];
  }
}

/** Whether a rate or a bound of the rules is a quality level. */
export function namesLevel({ collections }: Pick<RuleDocument, "collections">): boolean {
  const isLevel = (one: Statement | Action) =>
    (one.kind === "set" && (one.rate.kind === "tier" || one.margin?.to.kind === "tier")) ||
    (one.kind === "within" && typeof one.bound === "string");
  return statementsIn({ collections }).some((one) =>
    one.kind === "rule" ? [...one.then, ...one.else].some(isLevel) : isLevel(one),
  );
}

/** All checks of a condition in the order of the text. */
export function checksOf(condition: Condition): CheckCondition[] {
  if (condition.kind === "check") return [condition];
  if (condition.kind === "not" || condition.kind === "timed") return checksOf(condition.term);
  return condition.terms.flatMap(checksOf);
}

/** All statements of a document in the order of the text. */
export function statementsIn({ collections }: Pick<RuleDocument, "collections">): Statement[] {
  return collections.flatMap(({ statements }) => statements);
}

/** The words of comments that stand alone, by the number of the statement that comes next: its section begins there. */
export function sectionsOf(text: string, statements: readonly Statement[]): ReadonlyMap<number, string> {
  const sections = new Map<number, string>();
  let from = 0;
  statements.forEach(({ offset, end_offset }, index) => {
    const title = titleIn(text.slice(from, offset ?? from));
    if (title !== "") sections.set(index, title);
    from = end_offset ?? from;
  });
  return sections;
}

/** The last comment between two statements with an empty line behind it: what is directly above a statement is its own. */
function titleIn(between: string): string {
  if (!between.includes("//")) return "";
  let title: string[] = [];
  let comment: string[] = [];
  // The first line belongs to what stands before, the last one to what comes.
  for (const line of between.split("\n").slice(1, -1)) {
    const words = line.trim();
    if (words.startsWith("//")) {
      comment.push(words);
      continue;
    }
    if (/^(begin|end)\b/i.test(words)) title = [];
    else if (words === "" && comment.length > 0) title = comment;
    comment = [];
  }
  return title
    .map((line) => line.replace(/^[/\s=*-]+|[\s=*-]+$/g, ""))
    .join(" ")
    .trim();
}

/** Rules of a text with more than this many begin folded. */
const MANY_RULES = 20;

/** Which rules of a file are folded to one line, for as long as the page is open. */
export class Folds {
  /** What somebody chose, by the key of the statement. */
  private readonly chosen = new Map<string, boolean>();
  private usual: boolean | null = null;

  isFolded({ kind, key = "" }: Statement): boolean {
    return kind === "rule" && (this.chosen.get(key) ?? this.usual ?? false);
  }

  set(statement: Statement, isFolded: boolean): void {
    this.chosen.set(statement.key ?? "", isFolded);
  }

  setAll(isFolded: boolean): void {
    this.chosen.clear();
    this.usual = isFolded;
  }

  /** Goes on with a text that changed: rules whose words changed stay as they are, and new ones are open. */
  follow(before: readonly Statement[], after: readonly Statement[]): void {
    if (this.usual === null || before.length === 0) {
      this.usual ??= after.filter(({ kind }) => kind === "rule").length > MANY_RULES;
      return;
    }
    const known = new Set(before.map(({ key }) => key));
    const isSameCount = before.length === after.length;
    after.forEach((statement, index) => {
      const old = before[index];
      if (!known.has(statement.key)) this.set(statement, isSameCount && old !== undefined && this.isFolded(old));
    });
  }
}

const KEPT_MS = 5000;

interface Known {
  rules: Rules;
  key: string;
  askedMs: number;
  vocabulary: Vocabulary;
}

/** What to suggest; asked for when the rules name other topics than before, or a robot may have others by now. */
export class VocabularyCache {
  readonly vocabulary = signal<Vocabulary | null>(null);
  private known: Known | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly api: Api) {}

  /** What to suggest beside these rules. */
  async of(rules: Rules, document: Promise<RuleDocument>): Promise<Vocabulary> {
    const askedMs = performance.now();
    // The first time there is nothing to compare, and no reason to wait.
    const first = this.known === null ? this.ask(rules) : null;
    first?.catch(() => undefined);
    const key = JSON.stringify([rules.profile_text, [...topicsIn(await document)].sort()]);
    if (key !== this.known?.key || askedMs - this.known.askedMs >= KEPT_MS) {
      this.known = { rules, key, askedMs, vocabulary: await (first ?? this.ask(rules)) };
    }
    return this.known.vocabulary;
  }

  /** The words for somebody to choose from; they are asked for once more, as soon as they are 5 s old. */
  offered(): Vocabulary | null {
    if (this.known !== null && this.timer === undefined) {
      const dueMs = this.known.askedMs + KEPT_MS - performance.now();
      this.timer = setTimeout(() => void this.renew(), Math.max(0, dueMs));
    }
    return this.vocabulary.value;
  }

  private async renew(): Promise<void> {
    const { known } = this;
    this.timer = undefined;
    if (known === null) return;
    const askedMs = performance.now();
    // The top of the page says where a server does not answer.
    const vocabulary = await this.ask(known.rules).catch(() => null);
    if (vocabulary === null || known !== this.known) return;
    const isSame = JSON.stringify(vocabulary) === JSON.stringify(known.vocabulary);
    this.known = { ...known, askedMs, vocabulary: isSame ? known.vocabulary : vocabulary };
    // The same words again would be offered anew, and so be asked for without end.
    if (!isSame) this.vocabulary.value = vocabulary;
  }

  private ask({ text, profile_text }: Rules): Promise<Vocabulary> {
    return this.api.ask("POST /api/vocabulary", { text, profile_text });
  }
}
