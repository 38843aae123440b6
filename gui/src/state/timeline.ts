// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";
import type { Truth } from "../api/types";
import { durationWords } from "../ui/numbers";

/** What happened over the time of a recording, in seconds since its start, in bins of equal length. */
interface Course {
  readonly duration_s: number;
  readonly bin_s: number;
  readonly first_bin_s: number;
  readonly path: readonly (readonly [number, number, number])[];
}

/** The one time within a recording that everything below one slider shows. */
export class Timeline {
  readonly time = signal(0);
  /** Number of the bin that the time lies in. */
  readonly bin = computed(() => this.binAt(this.time.value));

  constructor(
    private readonly course: Course,
    private readonly bins: number,
    /** The time that charts call 0. */
    readonly zeroS: number,
    /** Times that have a line on every chart. */
    readonly marksS: readonly number[],
  ) {
    this.time.value = zeroS;
  }

  get durationS(): number {
    return this.course.duration_s;
  }

  /** The middle of each bin. */
  get binTimes(): number[] {
    const { first_bin_s, bin_s } = this.course;
    return Array.from({ length: this.bins }, (_, bin) => first_bin_s + (bin + 0.5) * bin_s);
  }

  goTo(time: number): void {
    this.time.value = Math.min(Math.max(time, 0), this.durationS);
  }

  /** Where the robot was, between the two points of its path around a time; null without a path. */
  placeAt(time: number): { place: [number, number]; heading_rad: number | null } | null {
    const { path } = this.course;
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
    const { first_bin_s, bin_s } = this.course;
    return Math.min(Math.max(Math.floor((time - first_bin_s) / bin_s), 0), this.bins - 1);
  }
}

/** How many of `sorted`, from the first on, `holds` is true of. */
export function upTo<T>(sorted: readonly T[], holds: (one: T) => boolean): number {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    const one = sorted[middle];
    if (one !== undefined && holds(one)) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** How much faster than the robot drove. */
export const SPEEDS = [0.5, 1, 2, 5, 10, 50] as const;

/** Moves the time of a recording on as the robot drove. */
export class Playback {
  readonly isPlaying = signal(false);
  readonly speed = signal<number>(1);
  private picture = 0;

  constructor(
    private readonly timeline: Timeline,
    /** From when to when it goes round and round, instead of once to the end. */
    private readonly loopS: readonly [number, number] | null = null,
  ) {}

  /** From where the slider is; from the start where that is the end. */
  play(): void {
    const { timeline } = this;
    const [startS, endS] = this.loopS ?? [0, timeline.durationS];
    const isWithin = (timeS: number) => timeS < endS && (this.loopS === null || timeS >= startS);
    if (!isWithin(timeline.time.peek())) timeline.goTo(startS);
    this.isPlaying.value = true;
    let beforeMs = performance.now();
    const step = (nowMs: number) => {
      // The first picture may have begun before the button was pressed.
      const passedS = Math.max(0, nowMs - beforeMs) / 1000;
      beforeMs = nowMs;
      timeline.goTo(Math.min(endS, timeline.time.peek() + passedS * this.speed.peek()));
      if (timeline.time.peek() >= endS && this.loopS !== null) timeline.goTo(startS);
      if (timeline.time.peek() >= endS) this.pause();
      else this.picture = requestAnimationFrame(step);
    };
    this.picture = requestAnimationFrame(step);
  }

  pause(): void {
    cancelAnimationFrame(this.picture);
    this.isPlaying.value = false;
  }
}

export type Turns = readonly (readonly [number, Truth])[];

/** What something was at a time; unknown before its first turn. */
export function truthAt(turns: Turns, timeS: number): Truth {
  return turns[upTo(turns, ([t]) => t <= timeS) - 1]?.[1] ?? "unknown";
}

/** From when to when something was true, false or unknown, in s; one ends where the next begins. */
interface Stretch {
  truth: Truth;
  fromS: number;
  toS: number;
}

/** The stretches between turns, of which none is empty. */
export function stretches(turns: Turns, durationS: number): Stretch[] {
  return turns
    .map(([fromS, truth], index) => ({ truth, fromS, toS: Math.min(turns[index + 1]?.[0] ?? durationS, durationS) }))
    .filter(({ fromS, toS }) => toS > fromS);
}

/** `Holds for 3 s of 8 s, in 2 stretches; unknown for 0.1 s`. */
export function holdsWords(turns: Turns, durationS: number): string {
  const all = stretches(turns, durationS);
  const seconds = (truth: Truth) =>
    all.filter((one) => one.truth === truth).reduce((sum, { fromS, toS }) => sum + toS - fromS, 0);
  const held = all.filter(({ truth }) => truth === "true").length;
  const often = held > 1 ? `, in ${held} stretches` : "";
  const unknownS = seconds("unknown");
  const unknown = unknownS > 0 ? `; unknown for ${durationWords(unknownS)}` : "";
  const holds =
    held === 0 ? "Never holds" : `Holds for ${durationWords(seconds("true"))} of ${durationWords(durationS)}`;
  return `${holds}${often}${unknown}`;
}
