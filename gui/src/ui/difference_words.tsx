// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import type { DifferenceAnswer } from "../api/types";
import { differingLines } from "../text/difference";
import { useAnswer } from "./later";

interface Props {
  api: Api;
  /** What stands above the sentences. */
  title: string;
  oldText: string;
  newText: string;
}

/** What a robot does otherwise with the new text of a rule file, in sentences. */
export function DifferenceWords({ api, title, oldText, newText }: Props) {
  const { answer, problem } = useAnswer(
    () => api.ask("POST /api/difference", { old_text: oldText, new_text: newText }),
    [oldText, newText],
  );
  if (problem) return <p class="problem">{problem}</p>;
  if (answer === null) return null;
  return (
    <div>
      {answer.differences.length > 0 && <p>{title}</p>}
      <ul class="differences" aria-label="Differences">
        {answer.differences.map((each) => (
          <li key={each}>{each}</li>
        ))}
      </ul>
      <p class="quiet">{reservation(answer)}</p>
    </div>
  );
}

/** What the sentences do not say. */
function reservation({ differences, old_parses, new_parses }: DifferenceAnswer): string {
  if (!old_parses || !new_parses) return "A text has errors of syntax: what cannot be read is not compared in words.";
  return differences.length === 0 ? "For a robot they are the same: comments, layout or order differ." : "";
}

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
