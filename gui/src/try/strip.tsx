// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Timeline } from "../state/timeline";
import { type OpenStrip, openStrip, type StripLines } from "./strip_plot";

/** A chart over a time, with the slider's time as a line. `lines` must stay the same object while they are the same. */
export function Strip(props: { timeline: Timeline; lines: StripLines; label: string; children: ComponentChildren }) {
  const { timeline, lines, label, children } = props;
  const host = useRef<HTMLDivElement>(null);
  const opened = useRef<OpenStrip | null>(null);
  useEffect(() => {
    if (host.current === null) return;
    opened.current = openStrip(host.current, timeline, lines);
    return opened.current.close;
  }, [timeline, lines.threshold, lines.isFixed]);
  useEffect(() => opened.current?.show(lines), [lines]);
  return (
    <figure class="strip" aria-label={label}>
      <figcaption>{children}</figcaption>
      <div ref={host} class="strip-plot" />
    </figure>
  );
}
