// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, useSignal } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { CheckCourse } from "../api/types";
import { BagWork } from "../state/bag_work";
import type { RuleEditor } from "../state/rule_editor";
import type { Trial } from "../state/trial";
import { holdsWords } from "../state/turns";
import { checksIn, thresholdEdits, type WrittenCheck, withValue } from "../state/written_checks";
import { NeedsServer } from "../ui/server_gone";
import { WorkProgress } from "../ui/work_progress";
import { Strip } from "./strip";
import { TruthBar } from "./truth_bar";

const ASK_AFTER_MS = 300;

interface Props {
  editor: RuleEditor;
  api: Api;
  trial: Trial;
}

/** For a check of the rules: its value over the recording, its threshold, and when it held. */
export function CheckCourses({ editor, api, trial }: Props) {
  const checks = useMemo(() => checksIn(editor.statements.value), [editor.statements.value]);
  const [chosen, setChosen] = useState(-1);
  const one = checks[chosen];
  if (checks.length === 0) return null;
  return (
    <section class="check-courses" aria-label="Why this threshold">
      <h3>Why this threshold</h3>
      <label>
        Value and threshold of
        <select value={chosen} onChange={(event) => setChosen(Number(event.currentTarget.value))}>
          <option value={-1}>Choose a check</option>
          {checks.map(({ rule, words }, index) => (
            <option key={index} value={index}>
              {words} ({rule})
            </option>
          ))}
        </select>
      </label>
      {one && <CourseOfCheck key={`${chosen} ${one.words}`} {...{ editor, api, trial, one }} />}
    </section>
  );
}

function CourseOfCheck({ editor, api, trial, one }: Props & { one: WrittenCheck }) {
  const { check, condition } = one;
  const value = useSignal(check.value);
  const work = useMemo(() => new BagWork<CheckCourse>(), []);
  const [course, setCourse] = useState<CheckCourse | null>(null);
  useEffect(() => () => work.cancel(), []);
  const asked = value.value;
  useEffect(() => {
    const ask = () =>
      void work.start((run, signal) => {
        const profile_text = editor.profile.peek()?.text ?? null;
        return api.checkCourse(
          { bag: trial.bag, condition: withValue(condition, check, asked), profile_text },
          run,
          signal,
        );
      });
    // Who drags is answered once the line rests.
    const timer = window.setTimeout(ask, course === null ? 0 : ASK_AFTER_MS);
    return () => window.clearTimeout(timer);
  }, [asked, trial]);
  const state = work.state.value;
  useEffect(() => {
    if (state.kind === "done") setCourse(state.answer);
  }, [state]);
  if (course === null) return <WorkProgress work={work} doing={`Reading ${check.topic} ${check.property}`} />;
  const isChanged = asked !== check.value;
  return (
    <>
      <CourseChart {...{ trial, one, course, value }} />
      <div class="truth-bars" aria-busy={state.kind === "running"}>
        <TruthBar turns={course.condition.turns} timeline={trial} label="The condition" />
        {condition.kind === "timed" && (
          <>
            <span>The check without its time:</span>
            <TruthBar turns={course.check.turns} timeline={trial} label="The check without its time" />
          </>
        )}
      </div>
      {state.kind === "failed" ? (
        <WorkProgress work={work} doing="" />
      ) : (
        <p role="status">
          {state.kind === "running"
            ? `Asking what ${asked} would do …`
            : `${check.op} ${asked}: ${holdsWords(course.condition.turns, course.duration_s)}.`}
        </p>
      )}
      {isChanged && (
        <NeedsServer>
          <div class="row">
            <button
              type="button"
              class="small"
              onClick={() => void editor.edit(() => thresholdEdits(editor.statements.peek(), check, asked))}
            >
              Write {asked} into the rules
            </button>
            <button type="button" class="small" onClick={() => (value.value = check.value)}>
              Back to {check.value}
            </button>
          </div>
        </NeedsServer>
      )}
      {course.notices.map((notice) => (
        <p key={notice} class="quiet">
          {notice}
        </p>
      ))}
    </>
  );
}

function CourseChart(props: { trial: Trial; one: WrittenCheck; course: CheckCourse; value: Signal<number> }) {
  const { trial, one, course } = props;
  const { topic, property } = one.check;
  // The values do not depend on the threshold: they are drawn once.
  const lines = useMemo(
    () => ({
      timesS: course.greatest.map((_, bin) => (bin + 0.5) * course.bin_s),
      least: course.least,
      after: course.greatest,
      threshold: props.value,
    }),
    [trial],
  );
  return (
    <Strip timeline={trial} lines={lines} label={`Value of ${topic} ${property}`}>
      <strong>{one.words}</strong>{" "}
      <span class="quiet">Drag the red line, or move it with the arrow keys, to see when another threshold holds.</span>
    </Strip>
  );
}
