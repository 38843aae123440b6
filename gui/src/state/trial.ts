// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed } from "@preact/signals";
import type { Rules } from "../api/client";
import type { FoundFile, Truth, TryAnswer, TryDecision } from "../api/types";
import { Timeline, upTo } from "./timeline";
import { type Turns, truthAt } from "./turns";

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
