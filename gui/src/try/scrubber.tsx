// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo } from "preact/hooks";
import { Playback, SPEEDS } from "../state/playback";
import type { Trial } from "../state/trial";
import { readable } from "../ui/numbers";

const STEPS = 500;
const WIDTH = 1000;

/** The one time that everything shows: a slider over the recording, with a tick for each decision. */
export function Scrubber({ trial }: { trial: Trial }) {
  const { durationS } = trial;
  const time = trial.time.value;
  const leader = trial.leader.value;
  const words = `${time.toFixed(1)} s of ${readable(durationS)} s, ${leader ? `${leader.rule} decides` : "defaults decide"}`;
  return (
    <div class="scrubber" role="group" aria-label="Time">
      <Player trial={trial} />
      <DecisionStep trial={trial} step={-1} label="Decision before" sign="◀" />
      <div class="scrubber-track">
        <svg viewBox={`0 0 ${WIDTH} 10`} preserveAspectRatio="none" aria-hidden="true">
          {trial.decisionTimes.map((t) => (
            <line key={t} x1={(WIDTH * t) / durationS} x2={(WIDTH * t) / durationS} y1={0} y2={10} />
          ))}
        </svg>
        <input
          type="range"
          aria-label="Time in the recording (s)"
          aria-valuetext={words}
          min={0}
          max={durationS}
          step={durationS / STEPS}
          value={time}
          onInput={(event) => trial.goTo(Number(event.currentTarget.value))}
        />
      </div>
      <DecisionStep trial={trial} step={1} label="Next decision" sign="▶" />
      <output class="number">{time.toFixed(1)} s</output>
    </div>
  );
}

/** Play and pause, and how fast. */
function Player({ trial }: { trial: Trial }) {
  const playback = useMemo(() => new Playback(trial), [trial]);
  useEffect(() => () => playback.pause(), [playback]);
  const isPlaying = playback.isPlaying.value;
  return (
    <>
      <button type="button" class="small player" onClick={() => (isPlaying ? playback.pause() : playback.play())}>
        {isPlaying ? "Pause" : "Play"}
      </button>
      <select
        aria-label="Speed"
        value={playback.speed.value}
        onChange={(event) => (playback.speed.value = Number(event.currentTarget.value))}
      >
        {SPEEDS.map((speed) => (
          <option key={speed} value={speed}>
            {speed}×
          </option>
        ))}
      </select>
    </>
  );
}

function DecisionStep({ trial, step, label, sign }: { trial: Trial; step: -1 | 1; label: string; sign: string }) {
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
      {sign}
    </button>
  );
}
