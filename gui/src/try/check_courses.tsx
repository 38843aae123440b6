// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, useSignal } from "@preact/signals";
import { type ComponentChildren, render } from "preact";
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { CheckCondition, CheckCourse, Condition } from "../api/types";
import { BagWork } from "../state/bag_work";
import { READ_AT_ONCE_BYTES } from "../state/recording_words";
import type { RuleEditor } from "../state/rule_editor";
import { holdsWords, Timeline } from "../state/timeline";
import type { Trial } from "../state/trial";
import { checksIn, type RobotCheck, withValue, writeThreshold } from "../state/written_checks";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { Notes, WorkProgress } from "../ui/notice";
import { sizeWords } from "../ui/numbers";
import { CheckChart, type HeldBar, OtherThreshold } from "./check_chart";

interface Props {
  editor: RuleEditor;
  trial: Trial;
}

/** For a check of the rules: its value over the recording, its threshold, and when it held. */
export function CheckCourses({ editor, trial }: Props) {
  const checks = useMemo(() => checksIn(editor.statements.value), [editor.statements.value]);
  const [chosen, setChosen] = useState(-1);
  const one = checks[chosen];
  if (checks.length === 0) return null;
  return (
    <section class="check-courses" aria-label="Why this threshold">
      <h3>Why this threshold</h3>
      <Choice
        label="Value and threshold of"
        value={chosen}
        choices={[
          [-1, "Choose a check"],
          ...checks.map(({ rule, words }, index) => [index, `${words} (${rule})`] as const),
        ]}
        choose={setChosen}
      />
      {one && (
        <CourseOfCheck
          key={`${chosen} ${one.words}`}
          {...{ one, api: editor.api, bag: trial.bag, timeline: trial }}
          profileText={editor.profile.peek()?.text ?? null}
          write={(value) => void writeThreshold(editor, value, () => one, "The rule was changed meanwhile")}
        />
      )}
    </section>
  );
}

interface OneProps {
  api: Api;
  bag: string;
  one: Pick<RobotCheck, "check" | "condition" | "words">;
  timeline: Timeline;
  profileText?: string | null;
  /** Writes another threshold into the rules. */
  write?: (value: number) => void;
  /** Whether nobody knows what the rules compared it with. */
  isValueOnly?: boolean;
}

/** The value of one check over a recording, its threshold, and when it held. */
export function CourseOfCheck({ api, bag, one, timeline, profileText = null, write, isValueOnly = false }: OneProps) {
  const { check, condition } = one;
  const written = check.value;
  const isNumber = typeof written === "number" && !isValueOnly;
  const threshold = useSignal(typeof written === "number" ? written : 0);
  const asked = useMemo(() => ({ bag, check, condition, profileText }), [timeline, one]);
  const { course, work } = useCheckCourse(api, asked, threshold.value);
  if (course === null) return <WorkProgress work={work} doing={`Reading ${check.topic} ${check.property}`} />;
  return (
    <>
      <CourseChart {...{ asked, course, work, threshold, timeline, isValueOnly }}>
        <strong>{one.words}</strong>{" "}
        {isNumber && (
          <span class="quiet">
            Drag the red line, or move it with the arrow keys, to see when another threshold holds.
          </span>
        )}
      </CourseChart>
      {isNumber && write && <OtherThreshold {...{ threshold, written, write }} />}
    </>
  );
}

interface CourseProps {
  asked: AskedCheck;
  course: CheckCourse;
  work: BagWork<CheckCourse>;
  threshold: Signal<number>;
  timeline: Timeline;
  isValueOnly?: boolean;
  children: ComponentChildren;
}

/** A check over a recording: its values, its threshold, when it held, and that in words. */
function CourseChart({ asked, course, work, threshold, timeline, isValueOnly = false, children }: CourseProps) {
  const { check, condition } = asked;
  // The values do not depend on the threshold: they are drawn once.
  const values = useMemo(() => course, [asked]);
  const { kind } = work.state.value;
  return (
    <>
      <CheckChart
        {...{ timeline, values, compared: check.value, threshold: isValueOnly ? null : threshold }}
        label={`Value of ${check.topic} ${check.property}`}
        bars={isValueOnly ? [] : heldBars(course, condition)}
        isBusy={kind === "running"}
      >
        {children}
      </CheckChart>
      {kind === "failed" ? (
        <WorkProgress work={work} doing="" />
      ) : (
        !isValueOnly && (
          <p role="status">
            {kind === "running"
              ? `Asking what ${threshold.value} would do …`
              : `${check.op} ${typeof check.value === "number" ? threshold.value : check.value}: ${holdsWords(course.condition.turns, course.duration_s)}.`}
          </p>
        )
      )}
      <Notes notes={course.notices} />
    </>
  );
}

const ASK_AFTER_MS = 300;

/** A check, the `For` and `Within` around it, and the recording that it is compared with. */
interface AskedCheck {
  bag: string;
  check: CheckCondition;
  condition: Condition;
  profileText: string | null;
}

/** What the check of `asked` would read and when it would hold with another threshold; null until that is known. */
function useCheckCourse(
  api: Api,
  asked: AskedCheck,
  threshold: number,
): { course: CheckCourse | null; work: BagWork<CheckCourse> } {
  const work = useMemo(() => new BagWork<CheckCourse>(), []);
  const [course, setCourse] = useState<CheckCourse | null>(null);
  useEffect(() => () => work.cancel(), []);
  useEffect(() => {
    const ask = () =>
      void work.start((run, signal) => {
        const isNumber = typeof asked.check.value === "number";
        const condition = isNumber ? withValue(asked.condition, asked.check, threshold) : asked.condition;
        return api.ask(
          "POST /api/check/course",
          { bag: asked.bag, condition, profile_text: asked.profileText, run },
          { signal },
        );
      });
    // While the line is dragged nothing is asked.
    const timer = window.setTimeout(ask, course === null ? 0 : ASK_AFTER_MS);
    return () => window.clearTimeout(timer);
  }, [threshold, asked.bag]);
  const state = work.state.value;
  useEffect(() => {
    if (state.kind === "done") setCourse(state.answer);
  }, [state]);
  return { course, work };
}

/** When a condition held, and, where it has a time, when its check did. */
function heldBars(course: CheckCourse, condition: Condition): HeldBar[] {
  const label = "The check without its time";
  return [
    { label: "The condition", turns: course.condition.turns },
    ...(condition.kind === "timed" ? [{ label, turns: course.check.turns, words: `${label}:` }] : []),
  ];
}

interface PickedProps {
  api: Api;
  asked: AskedCheck;
  sizeBytes: number;
  threshold: Signal<number>;
}

/** Draws below a field what its check reads in a recording; returns how to end that. */
export function drawPicked(host: HTMLElement, props: PickedProps): () => void {
  render(<PickedThreshold {...props} />, host);
  return () => render(null, host);
}

function PickedThreshold(props: PickedProps) {
  const [isAsked, setAsked] = useState(props.sizeBytes <= READ_AT_ONCE_BYTES);
  const { bag, check } = props.asked;
  if (isAsked) return <PickedCourse {...props} />;
  return (
    <Button
      label={`Show ${check.topic} ${check.property} in ${bag} (${sizeWords(props.sizeBytes / 1000)})`}
      class="small"
      onClick={() => setAsked(true)}
    />
  );
}

function PickedCourse({ api, asked, threshold }: PickedProps) {
  const { bag, check } = asked;
  const { course, work } = useCheckCourse(api, asked, threshold.value);
  const duration_s = course?.duration_s ?? 0;
  const timeline = useMemo(() => {
    const bin_s = course?.bin_s ?? 1;
    return new Timeline({ duration_s, bin_s, first_bin_s: 0, path: [] }, course?.least.length ?? 0, 0, []);
  }, [duration_s]);
  if (course === null) return <WorkProgress work={work} doing={`Reading ${bag}`} />;
  if (course.greatest.every((value) => value === null)) {
    return (
      <p class="quiet">
        {bag} has no values of {check.topic} {check.property}.
      </p>
    );
  }
  return (
    <CourseChart {...{ asked, course, work, threshold, timeline }}>
      <strong>
        {check.topic} {check.property}
      </strong>{" "}
      <span class="quiet">in {bag}. Drag the red line, or press ↑ and ↓.</span>
    </CourseChart>
  );
}
