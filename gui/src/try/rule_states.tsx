// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { TruthName } from "../api/types";
import type { RuleNow, Trial } from "../state/trial";
import { TruthBar } from "./truth_bar";

const WORDS: Record<TruthName, string> = { true: "holds", false: "does not hold", unknown: "unknown" };

/** Which rules hold at the time of the scrubber, and what each decides. `show` leads to a line of the rules. */
export function RuleStates({ trial, show }: { trial: Trial; show: ((line: number) => void) | null }) {
  const rules = trial.rules.value;
  if (rules.length === 0) return null;
  return (
    <section class="rule-states" aria-label="Rules at this time">
      <h3>Rules at {trial.time.value.toFixed(1)} s, and when they held</h3>
      <ul>
        {rules.map((rule, index) => (
          <li key={`${rule.line} ${rule.rule}`} class={rule.decides.length > 0 ? "decides" : undefined}>
            <span class={`truth ${rule.truth}`}>{WORDS[rule.truth]}</span>
            <RuleName rule={rule} show={show} />
            <TruthBar turns={trial.answer.blocks[index]?.turns ?? []} timeline={trial} label={rule.rule} />
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
  return (
    <button type="button" class="link" title="Show in the rules" onClick={() => show(rule.line)}>
      {rule.rule}
    </button>
  );
}
