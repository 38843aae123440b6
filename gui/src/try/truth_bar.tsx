// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import type { Timeline } from "../state/timeline";
import { holdsWords, stretches, type Turns } from "../state/turns";

const TRUTHS = ["true", "false", "unknown"] as const;

/** When something held, did not, or was unknown, over a recording; pressing or dragging on it moves the time. */
export function TruthBar({ turns, timeline, label }: { turns: Turns; timeline: Timeline; label: string }) {
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
  const scrub = (event: PointerEvent) => {
    if (event.buttons !== 1) return;
    const bar = event.currentTarget as Element;
    bar.setPointerCapture(event.pointerId);
    const { left, width } = bar.getBoundingClientRect();
    timeline.goTo(((event.clientX - left) / width) * durationS);
  };
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
