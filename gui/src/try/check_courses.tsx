// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useSignal } from "@preact/signals";
import { useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { RuleEditor } from "../state/rule_editor";
import type { Trial } from "../state/trial";
import { checksIn, type RobotCheck, writeThreshold } from "../state/written_checks";
import { Choice } from "../ui/choice";
import { WorkProgress } from "../ui/work_progress";
import { OtherThreshold } from "./check_chart";
import { CourseChart } from "./course_chart";
import { useCheckCourse } from "./use_check_course";

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
      <Choice
        label="Value and threshold of"
        value={chosen}
        choices={[
          [-1, "Choose a check"],
          ...checks.map(({ rule, words }, index) => [index, `${words} (${rule})`] as const),
        ]}
        choose={setChosen}
      />
      {one && <CourseOfCheck key={`${chosen} ${one.words}`} {...{ editor, api, trial, one }} />}
    </section>
  );
}

function CourseOfCheck({ editor, api, trial, one }: Props & { one: RobotCheck }) {
  const { check, condition } = one;
  const threshold = useSignal(check.value);
  const asked = useMemo(
    () => ({ bag: trial.bag, check, condition, profileText: editor.profile.peek()?.text ?? null }),
    [trial, one],
  );
  const { course, work } = useCheckCourse(api, asked, threshold.value);
  if (course === null) return <WorkProgress work={work} doing={`Reading ${check.topic} ${check.property}`} />;
  return (
    <>
      <CourseChart {...{ asked, course, work, threshold }} timeline={trial}>
        <strong>{one.words}</strong>{" "}
        <span class="quiet">
          Drag the red line, or move it with the arrow keys, to see when another threshold holds.
        </span>
      </CourseChart>
      <OtherThreshold
        threshold={threshold}
        written={check.value}
        write={(value) => void writeThreshold(editor, value, () => one, "The rule was changed meanwhile")}
      />
    </>
  );
}
