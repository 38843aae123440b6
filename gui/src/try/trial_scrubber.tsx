// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Trial } from "../state/trial";
import { Icon, type IconName } from "../ui/icon";
import { durationWords } from "../ui/numbers";
import { Scrubber } from "./scrubber";

/** The time of a try, with a tick for each decision. */
export function TrialScrubber({ trial }: { trial: Trial }) {
  const time = trial.time.value;
  const leader = trial.leader.value;
  const decides = leader ? `${leader.rule} decides` : "defaults decide";
  return (
    <Scrubber
      timeline={trial}
      label="Time in the recording (s)"
      words={`${time.toFixed(1)} s of ${durationWords(trial.durationS)}, ${decides}`}
      said={`${time.toFixed(1)} s`}
      ticksS={trial.decisionTimes}
      before={<DecisionStep trial={trial} step={-1} label="Decision before" icon="before" />}
      after={<DecisionStep trial={trial} step={1} label="Next decision" icon="after" />}
    />
  );
}

function DecisionStep({ trial, step, label, icon }: { trial: Trial; step: -1 | 1; label: string; icon: IconName }) {
  const next = trial.neighbour(step);
  return (
    <button
      type="button"
      class="small"
      aria-label={label}
      title={label}
      disabled={next === null}
      onClick={() => next !== null && trial.goTo(next)}
    >
      <Icon name={icon} />
    </button>
  );
}
