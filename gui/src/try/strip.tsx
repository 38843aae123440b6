// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Timeline } from "../state/timeline";
import { openStrip, type StripLines } from "./strip_plot";

/** A chart over the time of a recording, with the slider's time as a line. `lines` must stay the same object. */
export function Strip(props: { timeline: Timeline; lines: StripLines; label: string; children: ComponentChildren }) {
  const { timeline, lines, label, children } = props;
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => (host.current ? openStrip(host.current, timeline, lines) : undefined), [timeline, lines]);
  return (
    <figure class="strip" aria-label={label}>
      <figcaption>{children}</figcaption>
      <div ref={host} class="strip-plot" />
    </figure>
  );
}
