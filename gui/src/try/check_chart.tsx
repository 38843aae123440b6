// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import type { Compared } from "../api/types";
import type { Timeline, Turns } from "../state/timeline";
import type { RuleNow } from "../state/trial";
import { Button } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { counted } from "../ui/numbers";
import { Lane, ruleColour, TRUTH_WORDS, TruthBar, WordLane, type Words } from "./axis";
import { Chart } from "./chart";

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
  /** Null where none is known. */
  threshold: Signal<number> | null;
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
      ...(threshold && { threshold }),
      isFixed,
      ...(timeWords && { timeWords }),
    }),
    [values, threshold, isFixed],
  );
  return (
    <>
      {typeof compared === "number" ? (
        <Chart timeline={timeline} lines={lines} label={label}>
          {children}
        </Chart>
      ) : (
        <WordLane timeline={timeline} words={values.words} compared={compared} label={label}>
          {children}
        </WordLane>
      )}
      <div class="truth-bars" aria-busy={isBusy}>
        {bars.map((bar) => (
          <Lane key={bar.label} timeline={timeline} caption={bar.words}>
            <TruthBar turns={bar.turns} timeline={timeline} label={bar.label} />
          </Lane>
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

interface StatesProps {
  title: string;
  rules: readonly RuleNow[];
  timeline: Timeline;
  /** Leads to a line of the rules; null where they are not open. */
  show: ((line: number) => void) | null;
}

/** More rules than these are folded, those first that never held. */
const MOST_OPEN = 12;

/** Which rules hold at the time of a timeline, what each decides, and when they held: a lane and a colour for each. */
export function RuleLanes({ title, rules, timeline, show }: StatesProps) {
  if (rules.length === 0) return null;
  const all = rules.map((rule, at) => ({ rule, colour: ruleColour(at) }));
  const held = all.filter(({ rule }) => rule.turns.some(([, truth]) => truth === "true"));
  const open = rules.length > MOST_OPEN ? held.slice(0, MOST_OPEN) : all;
  const folded = all.filter((one) => !open.includes(one));
  const lanes = (some: typeof all) => (
    <ul>
      {some.map(({ rule, colour }) => (
        <li key={`${rule.line} ${rule.rule}`} class={rule.decides.length > 0 ? "decides" : undefined}>
          <Lane timeline={timeline} caption={<RuleCaption {...{ rule, colour, show }} />}>
            <TruthBar turns={rule.turns} timeline={timeline} label={rule.rule} colour={colour} />
          </Lane>
        </li>
      ))}
    </ul>
  );
  return (
    <section class="rule-states" aria-label="Rules at this time">
      <h3>{title}</h3>
      <p class="quiet">Filled: it held; pale: unknown; empty: it did not hold.</p>
      {lanes(open)}
      {folded.length > 0 && (
        <details>
          <summary>{counted(folded.length, "further rule")}</summary>
          {lanes(folded)}
        </details>
      )}
    </section>
  );
}

type CaptionProps = Pick<StatesProps, "show"> & { rule: RuleNow; colour: string };

function RuleCaption({ rule: { rule, line, truth, decides }, colour, show }: CaptionProps) {
  return (
    <>
      <span class={`truth ${truth}`}>{TRUTH_WORDS[truth]}</span>
      <i class="swatch" style={{ background: `var(${colour})` }} />
      {show === null ? (
        <span>{rule}</span>
      ) : (
        <Button label={rule} class="link" title="Show in the rules" onClick={() => show(line)} />
      )}
      {decides.length > 0 && (
        <span class="quiet" title={decides.join(", ")}>
          decides {decides.join(", ")}
        </span>
      )}
    </>
  );
}
