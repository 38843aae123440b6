// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { Playback, SPEEDS, type Timeline } from "../state/timeline";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";

const STEPS = 500;
const WIDTH = 1000;

interface ScrubberProps {
  timeline: Timeline;
  /** What a screen reader calls the slider, and its time. */
  label: string;
  words: string;
  /** The time for reading. */
  said: string;
  /** Times with a tick above the slider, besides the marks. */
  ticksS: readonly number[];
  /** Buttons on both sides of the slider. */
  before?: ComponentChildren;
  after?: ComponentChildren;
}

/** The one time that everything shows: a slider over the recording. */
export function Scrubber({ timeline, label, words, said, ticksS, before, after }: ScrubberProps) {
  const { durationS } = timeline;
  const at = (t: number) => (durationS > 0 ? (WIDTH * t) / durationS : 0);
  return (
    <div class="scrubber" role="group" aria-label="Time">
      <Player timeline={timeline} />
      {before}
      <div class="scrubber-track">
        <svg viewBox={`0 0 ${WIDTH} 10`} preserveAspectRatio="none" aria-hidden="true">
          {ticksS.map((t) => (
            <line key={t} x1={at(t)} x2={at(t)} y1={0} y2={10} />
          ))}
          {timeline.marksS.map((t) => (
            <line key={t} class="mark" x1={at(t)} x2={at(t)} y1={0} y2={10} />
          ))}
        </svg>
        <input
          type="range"
          aria-label={label}
          aria-valuetext={words}
          min={0}
          max={durationS}
          step={durationS / STEPS || 1}
          value={timeline.time.value}
          onInput={(event) => timeline.goTo(Number(event.currentTarget.value))}
        />
      </div>
      {after}
      <output class="number">{said}</output>
    </div>
  );
}

/** Play and pause, and how fast. */
function Player({ timeline }: { timeline: Timeline }) {
  const playback = useMemo(() => new Playback(timeline), [timeline]);
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
