// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import type { Truth } from "../api/types";
import { unquoted } from "../blocks/compared";
import { holdsWords, Playback, SPEEDS, stretches, type Timeline, type Turns } from "../state/timeline";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { durationWords } from "../ui/numbers";

interface AxisProps {
  timeline: Timeline;
  /** What a screen reader calls the slider, and its time. */
  label: string;
  words: string;
  /** The time for reading. */
  said: string;
  /** Times with a tick above the slider, besides the marks. */
  ticksS?: readonly number[];
  /** Buttons beside Play. */
  buttons?: ComponentChildren;
  /** From when to when Play goes round and round. */
  loopS?: readonly [number, number];
  /** What has no axis, as a map. */
  beside?: ComponentChildren;
  /** Lanes, and what stands between them. */
  children: ComponentChildren;
}

/** A slider over a time, and lanes below it: what stands below each other is at the same time. */
export function TimeAxis({ timeline, label, words, said, ticksS = NONE, ...shown }: AxisProps) {
  const { buttons, loopS, beside, children } = shown;
  const { durationS } = timeline;
  return (
    <div class={beside ? "time-axis with-beside" : "time-axis"}>
      <div class="scrubber" role="group" aria-label="Time">
        <div class="row">
          <Player timeline={timeline} loopS={loopS ?? null} />
          {buttons}
          <span class="said number">{said}</span>
        </div>
        <div class="scrubber-track">
          {ticksS.map((t) => (
            <i key={t} class="tick" style={placeOf(t, timeline)} />
          ))}
          <Marks timeline={timeline} />
          <input
            type="range"
            aria-label={label}
            aria-valuetext={words}
            min={0}
            max={durationS}
            step={durationS / SLIDER_STEPS || 1}
            value={timeline.time.value}
            onInput={(event) => timeline.goTo(Number(event.currentTarget.value))}
          />
        </div>
      </div>
      {beside && <div class="beside">{beside}</div>}
      <div class="lanes">{children}</div>
    </div>
  );
}

const NONE: readonly number[] = [];
const SLIDER_STEPS = 500;

function placeOf(timeS: number, { durationS }: Timeline): { left: string } {
  return { left: `${(100 * timeS) / (durationS || 1)}%` };
}

function Marks({ timeline }: { timeline: Timeline }) {
  return (
    <>
      {timeline.marksS.map((t) => (
        <i key={t} class="mark" style={placeOf(t, timeline)} />
      ))}
    </>
  );
}

function Now({ timeline }: { timeline: Timeline }) {
  return <i class="now" style={placeOf(timeline.time.value, timeline)} />;
}

/** Play and pause, and how fast. */
function Player({ timeline, loopS }: { timeline: Timeline; loopS: readonly [number, number] | null }) {
  const playback = useMemo(() => new Playback(timeline, loopS), [timeline]);
  useEffect(() => () => playback.pause(), [playback]);
  const isPlaying = playback.isPlaying.value;
  return (
    <>
      <Button
        label={isPlaying ? "Pause" : "Play"}
        class="small player"
        onClick={() => (isPlaying ? playback.pause() : playback.play())}
      />
      <Choice
        isBare
        label="Speed"
        value={playback.speed.value}
        choices={SPEEDS.map((speed) => [speed, `${speed}×`] as const)}
        choose={(speed) => (playback.speed.value = speed)}
      />
    </>
  );
}

interface LaneProps {
  timeline: Timeline;
  label?: string;
  /** What stands above it. */
  caption?: ComponentChildren;
  /** What is drawn over the time, as wide as every other lane. */
  children: ComponentChildren;
}

/** One thing over the time; pressing or dragging on it moves the time. */
export function Lane({ timeline, label, caption, children }: LaneProps) {
  const scrub = (event: PointerEvent) => {
    if (event.buttons !== 1) return;
    const plot = event.currentTarget as Element;
    plot.setPointerCapture(event.pointerId);
    const { left, width } = plot.getBoundingClientRect();
    timeline.goTo(((event.clientX - left) / width) * timeline.durationS);
  };
  return (
    <figure class="lane" aria-label={label}>
      {caption && <figcaption>{caption}</figcaption>}
      <div class="lane-plot" onPointerDown={scrub} onPointerMove={scrub}>
        {children}
        <Marks timeline={timeline} />
        <Now timeline={timeline} />
      </div>
    </figure>
  );
}

/** A stretch of time in a colour of the style sheet. */
export interface Stretch {
  fromS: number;
  toS: number;
  colour: string;
  isPale?: boolean;
}

interface BarProps {
  timeline: Timeline;
  parts: readonly Stretch[];
  /** What a screen reader says of it, and a pointer that stays on it. */
  label: string;
  title: string;
}

/** Stretches of time in colours. */
export function Bar({ timeline, parts, label, title }: BarProps) {
  const paths = useMemo(() => {
    const looks = new Map<string, string>();
    for (const { fromS, toS, colour, isPale } of parts) {
      const look = `fill: var(${colour}); ${isPale ? "opacity: 0.35" : ""}`;
      looks.set(look, `${looks.get(look) ?? ""}M${fromS} 0H${toS}V1H${fromS}Z`);
    }
    return [...looks];
  }, [parts]);
  return (
    <svg
      class="stretches"
      role="img"
      aria-label={label}
      viewBox={`0 0 ${timeline.durationS || 1} 1`}
      preserveAspectRatio="none"
    >
      <title>{title}</title>
      {paths.map(([look, path]) => (
        <path key={look} style={look} d={path} />
      ))}
    </svg>
  );
}

/** Of how many rules each has a colour of its own, as in a report; the next ones begin anew. */
const RULE_COLOURS = 6;

/** The colour of the rule that is so manieth of all. */
export function ruleColour(at: number): string {
  return `--rule-${(at % RULE_COLOURS) + 1}`;
}

interface TruthProps {
  timeline: Timeline;
  turns: Turns;
  label: string;
  colour?: string;
}

/** When something held: filled; pale where it was unknown. */
export function TruthBar({ timeline, turns, label, colour = "--accent" }: TruthProps) {
  const { durationS } = timeline;
  const words = holdsWords(turns, durationS);
  const parts = useMemo(() => {
    const all = stretches(turns, durationS).filter(({ truth }) => truth !== "false");
    return all.map(({ truth, fromS, toS }) => ({ fromS, toS, colour, isPale: truth === "unknown" }));
  }, [turns, durationS, colour]);
  return <Bar timeline={timeline} parts={parts} label={`${label}: ${words}`} title={words} />;
}

export const TRUTH_WORDS: Record<Truth, string> = { true: "holds", false: "does not hold", unknown: "unknown" };

/** From when on something was a word, in s; null where it was unknown. */
export type Words = readonly (readonly [number, string | null])[];

interface WordsProps {
  timeline: Timeline;
  words: Words;
  /** What the words are compared with, as a rule file spells it. */
  compared: string;
  label: string;
  children: ComponentChildren;
}

/** The words that a check read over time, one behind the other. */
export function WordLane({ timeline, words, compared, label, children }: WordsProps) {
  const { durationS } = timeline;
  const parts = useMemo(() => partsOf(words, durationS), [words, durationS]);
  const wanted = compared.startsWith('"') ? unquoted(compared) : compared;
  return (
    <Lane timeline={timeline} caption={children}>
      <div class="word-lane" role="img" aria-label={`${label}: ${totalsOf(parts)}`}>
        {parts.map(({ word, fromS, toS }) => (
          <span
            key={fromS}
            class={word === null ? "unknown" : word === wanted ? "wanted" : undefined}
            style={{ ...placeOf(fromS, timeline), width: placeOf(toS - fromS, timeline).left }}
            title={`${word ?? "unknown"} for ${durationWords(toS - fromS)}`}
          >
            {word ?? "?"}
          </span>
        ))}
      </div>
    </Lane>
  );
}

interface Part {
  word: string | null;
  fromS: number;
  toS: number;
}

function partsOf(words: Words, durationS: number): Part[] {
  return words
    .map(([fromS, word], at) => ({ word, fromS, toS: Math.min(words[at + 1]?.[0] ?? durationS, durationS) }))
    .filter(({ fromS, toS }) => toS > fromS);
}

/** `docking for 12 s, driving for 30 s`: the words in the order of their first time. */
function totalsOf(parts: readonly Part[]): string {
  const seconds = new Map<string, number>();
  for (const { word, fromS, toS } of parts) {
    const shown = word ?? "unknown";
    seconds.set(shown, (seconds.get(shown) ?? 0) + toS - fromS);
  }
  return [...seconds].map(([word, total]) => `${word} for ${durationWords(total)}`).join(", ") || "no values";
}
