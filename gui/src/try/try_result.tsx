// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Api } from "../api/client";
import type { Keepings } from "../state/keepings";
import type { RuleEditor } from "../state/rule_editor";
import type { Trial } from "../state/trial";
import { showOnNarrow } from "../ui/narrow";
import { counted, durationWords, sizeWords } from "../ui/numbers";
import { CheckCourses } from "./check_courses";
import { DecisionTable } from "./decision_table";
import { LossTables } from "./loss_tables";
import { RateStrips } from "./rate_strips";
import { RuleStates } from "./rule_states";
import { showInEditor } from "./show_in_editor";
import { TrialScrubber } from "./trial_scrubber";
import { TriedIncidents } from "./tried_incidents";
import { TryMap } from "./try_map";
import { worstLoss } from "./worst_loss";

interface Props {
  editor: RuleEditor;
  api: Api;
  trial: Trial;
  keepings: Keepings;
  /** What is another one since the try: `rules`, `profile`, `recording`. */
  changed: readonly string[];
}

/** A try: what it saved, and below one scrubber the map, the rules, the rates, the loss and every decision. */
export function TryResult({ editor, api, trial, keepings, changed }: Props) {
  const { answer } = trial;
  const worst = worstLoss(answer.loss);
  const isOld = editor.text.value !== trial.text;
  const result = useRef<HTMLDivElement>(null);
  useEffect(() => followInEditor(editor, trial), [trial]);
  useEffect(() => showOnNarrow(() => result.current), [trial]);
  return (
    <div class="try-result" ref={result}>
      <p class="headline" role="status">
        <strong>{answer.percent.toFixed(1)} % less sent</strong>
        {worst && `; ${worst}`}
      </p>
      <p class="quiet">
        {sizeWords(answer.after_kb)} of {sizeWords(answer.before_kb)} in {durationWords(answer.duration_s)}. The rules
        decided {counted(answer.decision_count, "time")}
        {answer.path.length > 1 && ", where the map has dots"}.
      </p>
      {changed.length > 0 && (
        <p class="notice warning" role="status">
          Stale: {andWords(changed)} changed since. Run the rules again to see what they do now.
        </p>
      )}
      {answer.notices.length > 0 && (
        <div class="quiet">
          {answer.notices.map((notice) => (
            <p key={notice}>{notice}</p>
          ))}
        </div>
      )}
      <TrialScrubber trial={trial} />
      <RuleStates
        title={`Rules at ${trial.time.value.toFixed(1)} s, and when they held`}
        rules={trial.rules.value}
        timeline={trial}
        show={isOld ? null : (line) => showInEditor(editor, line)}
      />
      <CheckCourses {...{ editor, api, trial }} />
      <TriedIncidents keepings={keepings} trial={trial} />
      <div class="try-columns">
        <div class="try-column">
          {answer.path.length > 1 && <TryMap {...{ editor, api, trial }} />}
          <LossTables trial={trial} />
        </div>
        <div class="try-column">
          <RateStrips trial={trial} />
          <DecisionTable trial={trial} />
        </div>
      </div>
    </div>
  );
}

/** Marks in text and blocks which rule decides, from when somebody moves the time. */
function followInEditor(editor: RuleEditor, trial: Trial): () => void {
  const opened = trial.time.peek();
  let shown: number | null | undefined;
  return effect(() => {
    const line = trial.leader.value?.line ?? null;
    if (trial.time.value === opened && shown === undefined) return;
    if (line === shown || editor.text.peek() !== trial.text) return;
    shown = line;
    showInEditor(editor, line);
  });
}

/** `rules and recording`. */
function andWords(words: readonly string[]): string {
  return [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");
}
