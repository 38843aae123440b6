// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import type { Timeline } from "./timeline";

/** How much faster than the robot drove. */
export const SPEEDS = [0.5, 1, 2, 5, 10, 50] as const;

/** Moves the time of a recording on as the robot drove. */
export class Playback {
  readonly isPlaying = signal(false);
  readonly speed = signal<number>(1);
  private picture = 0;

  constructor(private readonly timeline: Timeline) {}

  /** From where the slider is; from the start where that is the end. */
  play(): void {
    const { timeline } = this;
    if (timeline.time.peek() >= timeline.durationS) timeline.goTo(0);
    this.isPlaying.value = true;
    let beforeMs = performance.now();
    const step = (nowMs: number) => {
      // The first picture may have begun before the button was pressed.
      const passedS = Math.max(0, nowMs - beforeMs) / 1000;
      beforeMs = nowMs;
      timeline.goTo(Math.min(timeline.durationS, timeline.time.peek() + passedS * this.speed.peek()));
      if (timeline.time.peek() >= timeline.durationS) this.pause();
      else this.picture = requestAnimationFrame(step);
    };
    this.picture = requestAnimationFrame(step);
  }

  pause(): void {
    cancelAnimationFrame(this.picture);
    this.isPlaying.value = false;
  }
}
