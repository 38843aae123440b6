// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { differingLines } from "../text/difference";

/** The lines in which two texts differ, side by side; `a` and `b` are what the texts are called. */
export function TextComparison(props: { a: string; textA: string; b: string; textB: string }) {
  const { line, a, b } = differingLines(props.textA, props.textB);
  return (
    <div class="versions">
      <Side title={`${props.a}, from line ${line}`} text={a} />
      <Side title={`${props.b}, from line ${line}`} text={b} />
    </div>
  );
}

function Side({ title, text }: { title: string; text: string }) {
  return (
    <figure aria-label={title}>
      <figcaption class="quiet">{title}</figcaption>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach */}
      <pre tabIndex={0}>{text || "(nothing)"}</pre>
    </figure>
  );
}
