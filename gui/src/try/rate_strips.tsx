// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import type { TryTopic } from "../api/types";
import type { Trial } from "../state/trial";
import { hz, readable } from "../ui/numbers";
import { Strip } from "./strip";

const IN_DOUBT: Record<string, string> = { unknown: ", which might hold" };

/** The rate of every topic over time, before and after, on one cursor. */
export function RateStrips({ trial }: { trial: Trial }) {
  return (
    <section aria-label="Rates">
      <h3>Rates (Hz) over time (s)</h3>
      <p class="quiet">Dashed as recorded, filled with the rules. Press or drag on a chart to move the time.</p>
      {trial.answer.topics.map((topic) => (
        <RateStrip key={topic.topic} {...{ trial, topic }} />
      ))}
    </section>
  );
}

function RateStrip({ trial, topic }: { trial: Trial; topic: TryTopic }) {
  const lines = useMemo(
    () => ({ before: trial.whole(topic.before_hz_bins), after: trial.whole(topic.after_hz_bins) }),
    [trial, topic],
  );
  return (
    <Strip timeline={trial} lines={lines} label={`Rate of ${topic.topic}`}>
      <strong>{topic.topic}</strong> <RateNow {...{ trial, topic }} />
    </Strip>
  );
}

function RateNow({ trial, topic }: { trial: Trial; topic: TryTopic }) {
  const bin = trial.bin.value;
  const decision = trial.plan.value.get(topic.topic);
  const [before, after] = [topic.before_hz_bins[bin] ?? 0, topic.after_hz_bins[bin] ?? 0];
  return (
    <span class="quiet">
      {decision && `${hz(decision.to_hz)} by ${decision.rule ?? decision.reason}${IN_DOUBT[decision.reason] ?? ""}: `}
      {readable(after)} of {readable(before)} Hz sent
    </span>
  );
}
