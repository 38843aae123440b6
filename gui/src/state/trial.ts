// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";
import { type Api, problemWords, type Rules } from "../api/client";
import type { FoundFile, Truth, TryAnswer, TryDecision, TryHeadline } from "../api/types";
import { partOf } from "./bag_work";
import { Timeline, type Turns, truthAt, upTo } from "./timeline";

/** A rule, or its Else, at one time. */
export interface RuleNow {
  rule: string;
  line: number;
  truth: Truth;
  /** What it is when. */
  turns: Turns;
  /** The topics whose rate it decides. */
  decides: string[];
}

/** What a try on a bag said, and the one time that everything shows. */
export class Trial extends Timeline {
  /** The decision that each topic's rate comes from. */
  readonly plan = computed(() => this.planAt(this.time.value));
  readonly rules = computed(() => this.rulesAt(this.time.value, this.plan.value));
  /** The rule that decides most topics, the first in the file among equals; null where defaults decide. */
  readonly leader = computed(() => leading(this.rules.value));
  readonly decisionTimes: readonly number[];
  private readonly byTopic = new Map<string, TryDecision[]>();

  constructor(
    readonly answer: TryAnswer,
    /** What was tried. */
    readonly tried: Rules,
    readonly bag: string,
    /** The recording as the project had it then. */
    readonly recordings: readonly [FoundFile | undefined],
  ) {
    super(answer, answer.topics[0]?.before_hz_bins.length ?? 0, 0, answer.incidents?.map(({ t }) => t) ?? []);
    for (const decision of answer.decisions) {
      const own = this.byTopic.get(decision.topic) ?? [];
      own.push(decision);
      this.byTopic.set(decision.topic, own);
    }
    const changes = answer.decisions.filter((each) => each.start !== true).map((each) => each.t);
    this.decisionTimes = [...new Set(changes)].sort((a, b) => a - b);
  }

  /** The mean rate of a topic in the recording; null where it has none. */
  sourceHz(topic: string): number | null {
    const own = this.answer.topics.find((each) => each.topic === topic);
    return own && this.durationS > 0 ? own.outcome.in / this.durationS : null;
  }

  /** The least and the greatest value of a property in the recording, where it was looked into. */
  rangeOf(topic: string, property: string): readonly [number, number] | null {
    return this.answer.loss.fields.find((each) => each.topic === topic && each.field === property)?.sent ?? null;
  }

  /** `bins` without those that the recording covers only in part: they would look like drops. */
  whole(bins: readonly number[]): (number | null)[] {
    const last = bins.length - 1;
    return bins.map((value, bin) =>
      last > 1 && (bin === last || (bin === 0 && this.answer.first_bin_s < 0)) ? null : value,
    );
  }

  /** The time of the decision before (-1) or after (1) now; null where there is none. */
  neighbour(step: -1 | 1): number | null {
    const now = this.time.value;
    const found = step > 0 ? this.decisionTimes.find((t) => t > now) : this.decisionTimes.findLast((t) => t < now);
    return found ?? null;
  }

  private planAt(time: number): Map<string, TryDecision> {
    const plan = new Map<string, TryDecision>();
    // Where there were too many decisions, nothing is said of what came after the last one that is known.
    const { decisions, decision_count } = this.answer;
    if (decision_count > decisions.length && time > (decisions.at(-1)?.t ?? 0)) return plan;
    for (const [topic, decisions] of this.byTopic) {
      const latest = decisions[upTo(decisions, ({ t }) => t <= time) - 1] ?? decisions[0];
      if (latest) plan.set(topic, latest);
    }
    return plan;
  }

  private rulesAt(time: number, plan: Map<string, TryDecision>): RuleNow[] {
    return this.answer.blocks.map(({ rule, line, turns }) => ({
      rule,
      line,
      truth: truthAt(turns, time),
      turns,
      decides: [...plan.values()].filter((each) => each.line === line && each.rule === rule).map((each) => each.topic),
    }));
  }
}

function leading(rules: readonly RuleNow[]): RuleNow | null {
  const most = Math.max(0, ...rules.map(({ decides }) => decides.length));
  return (most > 0 && rules.find(({ decides }) => decides.length === most)) || null;
}

/** What a try on a recording says first. */
export interface TriedRow {
  bag: string;
  headline: TryHeadline;
}

/** How many rows, and how many recordings that could not be tried, are shown. */
export const MAX_ROWS = 100;

/** The tries of rules on the recordings of a folder: those that are done. */
export class FolderTrial {
  /** In the order in which they were tried. */
  readonly rows = signal<readonly TriedRow[]>([]);
  /** The recordings that could not be tried, with cause and remedy. */
  readonly problems = signal<readonly { bag: string; why: string }[]>([]);
  /** How the rows are sorted where somebody looks at them. */
  readonly order = signal<Order>(WORST_FIRST);
  /** The first `MAX_ROWS` in that order. */
  readonly shown = computed(() => sorted(this.rows.value, this.order.value).slice(0, MAX_ROWS));

  constructor(
    readonly folder: string,
    /** What was tried. */
    readonly tried: Rules,
    /** The recordings as the project had them then. */
    readonly recordings: readonly FoundFile[],
  ) {}

  get done(): number {
    return this.rows.value.length + this.problems.value.length;
  }

  /** What the folder calls a recording in it. */
  nameOf(bag: string): string {
    return bag.startsWith(this.folder) ? bag.slice(this.folder.length) : bag;
  }

  /** How far all are, where recording `number` was so far when that was told. */
  share(ofOne: number, number: number): number {
    return (this.done + (number === this.done ? ofOne : 0)) / this.recordings.length;
  }

  /** Tries one recording after the other, and tells how far all are; what ends it leaves what is done. */
  async run(api: Api, run: string, signal: AbortSignal, setShare: (share: number) => void): Promise<this> {
    for (const [number, { name: bag }] of this.recordings.entries()) {
      const { headline, problem, remedy } = await api.ask(
        "POST /api/try/headline",
        { ...this.tried, bag, run: partOf(run, number) },
        { signal },
      );
      if (headline !== null) this.rows.value = [...this.rows.value, { bag, headline }];
      else this.problems.value = [...this.problems.value, { bag, why: problemWords({ message: problem, remedy }) }];
      setShare(this.share(0, this.done));
    }
    return this;
  }
}

/** All together: sums, and what is less of what was sent. */
export function totalOf(
  rows: readonly TriedRow[],
): Pick<TryHeadline, "duration_s" | "after_kb" | "percent"> & Pick<TryHeadline, "crossings" | "missed_crossings"> {
  const sum = (of: (headline: TryHeadline) => number) => rows.reduce((all, { headline }) => all + of(headline), 0);
  const [before, after] = [sum((one) => one.before_kb), sum((one) => one.after_kb)];
  return {
    duration_s: sum((one) => one.duration_s),
    after_kb: after,
    percent: before > 0 ? 100 * (1 - after / before) : 0,
    crossings: sum((one) => one.crossings),
    missed_crossings: sum((one) => one.missed_crossings),
  };
}

/** KB/s; null where nothing takes time. */
export function sentKbPerS({ after_kb, duration_s }: Pick<TryHeadline, "after_kb" | "duration_s">): number | null {
  return duration_s > 0 ? after_kb / duration_s : null;
}

type Key = (row: TriedRow) => number | string;

const lossOf: Key = ({ headline: { worst_topic: worst } }) =>
  worst === null ? Number.NEGATIVE_INFINITY : (worst.more_s ?? Number.POSITIVE_INFINITY);
const errorOf: Key = ({ headline }) => headline.worst_field?.share ?? 0;
const missedOf: Key = ({ headline }) => headline.missed_crossings;
const nameOf: Key = ({ bag }) => bag;

/** What rows are sorted by, and whether the largest stands first where somebody first asks for it. */
export const COLUMNS = {
  recording: { title: "Recording", key: nameOf, isDown: false },
  sent: { title: "Sent (KB/s)", key: ({ headline }) => sentKbPerS(headline) ?? 0, isDown: true },
  less: { title: "Less sent (%)", key: ({ headline }) => headline.percent, isDown: false },
  loss: { title: "Largest loss", key: lossOf, isDown: true },
  error: { title: "Largest error (RMSE)", key: errorOf, isDown: true },
  missed: { title: "Thresholds missed", key: missedOf, isDown: true },
} as const satisfies Record<string, { title: string; key: Key; isDown: boolean }>;

export type Column = keyof typeof COLUMNS;

interface Order {
  column: Column;
  isDown: boolean;
}

/** The largest loss first: the topic whose newest message was old for longest, compared with the robot. */
export const WORST_FIRST: Order = { column: "loss", isDown: true };

/** The rows in an order; among equals the worst stands first. */
function sorted(rows: readonly TriedRow[], { column, isDown }: Order): TriedRow[] {
  const sign = isDown ? -1 : 1;
  return [...rows].sort(
    (a, b) =>
      sign * compared(COLUMNS[column].key, a, b) ||
      -compared(lossOf, a, b) ||
      -compared(missedOf, a, b) ||
      -compared(errorOf, a, b) ||
      compared(nameOf, a, b),
  );
}

function compared(key: Key, a: TriedRow, b: TriedRow): number {
  const [one, other] = [key(a), key(b)];
  return one < other ? -1 : one > other ? 1 : 0;
}
