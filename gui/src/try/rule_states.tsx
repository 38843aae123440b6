// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Truth } from "../api/types";
import type { Timeline } from "../state/timeline";
import type { RuleNow } from "../state/trial";
import { Button } from "../ui/button";
import { TruthBar } from "./check_chart";

const WORDS: Record<Truth, string> = { true: "holds", false: "does not hold", unknown: "unknown" };

interface Props {
  title: string;
  rules: readonly RuleNow[];
  timeline: Timeline;
  /** Leads to a line of the rules; null where they are not open. */
  show: ((line: number) => void) | null;
}

/** Which rules hold at the time of a timeline, what each decides, and when they held. */
export function RuleStates({ title, rules, timeline, show }: Props) {
  if (rules.length === 0) return null;
  return (
    <section class="rule-states" aria-label="Rules at this time">
      <h3>{title}</h3>
      <ul>
        {rules.map((rule) => (
          <li key={`${rule.line} ${rule.rule}`} class={rule.decides.length > 0 ? "decides" : undefined}>
            <span class={`truth ${rule.truth}`}>{WORDS[rule.truth]}</span>
            <RuleName rule={rule} show={show} />
            <TruthBar turns={rule.turns} timeline={timeline} label={rule.rule} />
            {rule.decides.length > 0 && (
              <span class="quiet" title={rule.decides.join(", ")}>
                decides {rule.decides.join(", ")}
              </span>
            )}
          </li>
        ))}
      </ul>
    </section>
  );
}

function RuleName({ rule, show }: { rule: RuleNow; show: ((line: number) => void) | null }) {
  if (show === null) return <span>{rule.rule}</span>;
  return <Button label={rule.rule} class="link" title="Show in the rules" onClick={() => show(rule.line)} />;
}
