// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import type { Compared, Truth } from "../api/types";
import { holdsWords, scrubOn, stretches, type Timeline, type Turns } from "../state/timeline";
import type { RuleNow } from "../state/trial";
import { Button } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { Strip } from "./strip";
import { WordLane, type Words } from "./word_lane";

/** The least and the greatest value of a check in bins of equal length; null where it was unknown throughout. */
interface CheckValues {
  bin_s: number;
  first_bin_s?: number;
  least: readonly (number | null)[];
  greatest: readonly (number | null)[];
  /** What was read from when on, of a check that compares with no number. */
  words: Words;
}

/** When something held; `words` stand above its bar. */
export interface HeldBar {
  label: string;
  turns: Turns;
  words?: string;
}

interface Props {
  timeline: Timeline;
  /** Must stay the same object while the values are the same. */
  values: CheckValues;
  threshold: Signal<number>;
  /** What the check compares with; words are drawn as a lane in place of a line. */
  compared: Compared;
  /** Whether the threshold can only be looked at. */
  isFixed?: boolean;
  timeWords?: (timeS: number) => string;
  label: string;
  bars: readonly HeldBar[];
  isBusy: boolean;
  children: ComponentChildren;
}

/** The value of a check over time, its threshold as a line, and below it bars of when something held. */
export function CheckChart({ timeline, values, threshold, isFixed = false, timeWords, label, ...shown }: Props) {
  const { bars, compared, isBusy, children } = shown;
  const lines = useMemo(
    () => ({
      timesS: values.greatest.map((_, bin) => (values.first_bin_s ?? 0) + (bin + 0.5) * values.bin_s),
      least: values.least,
      after: values.greatest,
      threshold,
      isFixed,
      ...(timeWords && { timeWords }),
    }),
    [values, threshold, isFixed],
  );
  return (
    <>
      {typeof compared === "number" ? (
        <Strip timeline={timeline} lines={lines} label={label}>
          {children}
        </Strip>
      ) : (
        <WordLane timeline={timeline} words={values.words} compared={compared} label={label}>
          {children}
        </WordLane>
      )}
      <div class="truth-bars" aria-busy={isBusy}>
        {bars.map((bar) => (
          <div key={bar.label}>
            {bar.words && <span>{bar.words}</span>}
            <TruthBar turns={bar.turns} timeline={timeline} label={bar.label} />
          </div>
        ))}
      </div>
    </>
  );
}

interface OtherProps {
  threshold: Signal<number>;
  /** The threshold that the rules have. */
  written: number;
  write: (threshold: number) => void;
}

/** What can be done with a threshold that was dragged: it goes into the rules, or back to theirs. */
export function OtherThreshold({ threshold, written, write }: OtherProps) {
  const { value } = threshold;
  if (value === written) return null;
  return (
    <NeedsServer>
      <div class="row">
        <Button label={`Write ${value} into the rules`} class="small" onClick={() => write(value)} />
        <Button label={`Back to ${written}`} class="small" onClick={() => (threshold.value = written)} />
      </div>
    </NeedsServer>
  );
}

const TRUTHS = ["true", "false", "unknown"] as const;

/** When something held, did not, or was unknown, over a recording; pressing or dragging on it moves the time. */
function TruthBar({ turns, timeline, label }: { turns: Turns; timeline: Timeline; label: string }) {
  const { durationS } = timeline;
  const paths = useMemo(() => {
    const all = stretches(turns, durationS);
    const path = (truth: string) =>
      all
        .filter((one) => one.truth === truth)
        .map(({ fromS, toS }) => `M${fromS} 0H${toS}V1H${fromS}Z`)
        .join("");
    return TRUTHS.map((truth) => ({ truth, path: path(truth) }));
  }, [turns, durationS]);
  const scrub = (event: PointerEvent) => scrubOn(event, timeline);
  return (
    <svg
      class="truth-bar"
      role="img"
      aria-label={`${label}: ${holdsWords(turns, durationS)}`}
      viewBox={`0 0 ${durationS || 1} 1`}
      preserveAspectRatio="none"
      onPointerDown={scrub}
      onPointerMove={scrub}
    >
      <title>{holdsWords(turns, durationS)}</title>
      {paths.map(({ truth, path }) => path && <path key={truth} class={truth} d={path} />)}
      <line x1={timeline.time.value} x2={timeline.time.value} y1={0} y2={1} />
    </svg>
  );
}

const TRUTH_WORDS: Record<Truth, string> = { true: "holds", false: "does not hold", unknown: "unknown" };

interface StatesProps {
  title: string;
  rules: readonly RuleNow[];
  timeline: Timeline;
  /** Leads to a line of the rules; null where they are not open. */
  show: ((line: number) => void) | null;
}

/** Which rules hold at the time of a timeline, what each decides, and when they held. */
export function RuleStates({ title, rules, timeline, show }: StatesProps) {
  if (rules.length === 0) return null;
  return (
    <section class="rule-states" aria-label="Rules at this time">
      <h3>{title}</h3>
      <ul>
        {rules.map((rule) => (
          <li key={`${rule.line} ${rule.rule}`} class={rule.decides.length > 0 ? "decides" : undefined}>
            <span class={`truth ${rule.truth}`}>{TRUTH_WORDS[rule.truth]}</span>
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
