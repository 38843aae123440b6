// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";
import type { TruthName, TryAnswer, TryDecision } from "../api/types";

/** A rule, or its Else, at one time. */
export interface RuleNow {
  rule: string;
  line: number;
  truth: TruthName;
  /** The topics whose rate it decides. */
  decides: string[];
}

/** What a try on a bag said, and the one time that everything shows. */
export class Trial {
  readonly time = signal(0);
  /** Number of the bin that the time lies in. */
  readonly bin = computed(() => this.binAt(this.time.value));
  /** The decision that each topic's rate comes from. */
  readonly plan = computed(() => this.planAt(this.time.value));
  readonly rules = computed(() => this.rulesAt(this.time.value, this.plan.value));
  /** The rule that decides most topics, the first in the file among equals; null where defaults decide. */
  readonly leader = computed(() => leading(this.rules.value));
  readonly decisionTimes: readonly number[];
  private readonly byTopic = new Map<string, TryDecision[]>();

  constructor(
    readonly answer: TryAnswer,
    /** The rules that were tried. */
    readonly text: string,
    readonly bag: string,
  ) {
    for (const decision of answer.decisions) {
      const own = this.byTopic.get(decision.topic) ?? [];
      own.push(decision);
      this.byTopic.set(decision.topic, own);
    }
    const changes = answer.decisions.filter((each) => each.start !== true).map((each) => each.t);
    this.decisionTimes = [...new Set(changes)].sort((a, b) => a - b);
  }

  get durationS(): number {
    return this.answer.duration_s;
  }

  /** The middle of each bin. */
  get binTimes(): number[] {
    const { first_bin_s, bin_s, topics } = this.answer;
    const count = topics[0]?.before_hz_bins.length ?? 0;
    return Array.from({ length: count }, (_, bin) => first_bin_s + (bin + 0.5) * bin_s);
  }

  /** `bins` without those that the recording covers only in part: they would look like drops. */
  whole(bins: readonly number[]): (number | null)[] {
    const last = bins.length - 1;
    return bins.map((value, bin) =>
      last > 1 && (bin === last || (bin === 0 && this.answer.first_bin_s < 0)) ? null : value,
    );
  }

  goTo(time: number): void {
    this.time.value = Math.min(Math.max(time, 0), this.durationS);
  }

  /** The time of the decision before (-1) or after (1) now; null where there is none. */
  neighbour(step: -1 | 1): number | null {
    const now = this.time.value;
    const found = step > 0 ? this.decisionTimes.find((t) => t > now) : this.decisionTimes.findLast((t) => t < now);
    return found ?? null;
  }

  /** Where the robot was, between the two points of its path around a time; null without a path. */
  placeAt(time: number): { place: [number, number]; heading_rad: number | null } | null {
    const { path } = this.answer;
    const after = Math.min(
      upTo(path, ([t]) => t <= time),
      path.length - 1,
    );
    const [next, last] = [path[after], path[Math.max(after - 1, 0)]];
    if (!next || !last) return null;
    const share = next[0] > last[0] ? Math.min(Math.max((time - last[0]) / (next[0] - last[0]), 0), 1) : 0;
    const [dx, dy] = [next[1] - last[1], next[2] - last[2]];
    const heading_rad = Math.hypot(dx, dy) > 1e-3 ? Math.atan2(dy, dx) : null;
    return { place: [last[1] + share * dx, last[2] + share * dy], heading_rad };
  }

  private binAt(time: number): number {
    const { first_bin_s, bin_s, topics } = this.answer;
    const last = (topics[0]?.before_hz_bins.length ?? 1) - 1;
    return Math.min(Math.max(Math.floor((time - first_bin_s) / bin_s), 0), last);
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
      truth: turns[upTo(turns, ([t]) => t <= time) - 1]?.[1] ?? "unknown",
      decides: [...plan.values()].filter((each) => each.line === line && each.rule === rule).map((each) => each.topic),
    }));
  }
}

function leading(rules: readonly RuleNow[]): RuleNow | null {
  const most = Math.max(0, ...rules.map(({ decides }) => decides.length));
  return (most > 0 && rules.find(({ decides }) => decides.length === most)) || null;
}

/** How many of `sorted`, from the first on, `holds` is true of. */
function upTo<T>(sorted: readonly T[], holds: (one: T) => boolean): number {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    const one = sorted[middle];
    if (one !== undefined && holds(one)) low = middle + 1;
    else high = middle;
  }
  return low;
}
