// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import type { CheckCourse } from "../api/types";
import type { BagWork } from "../state/bag_work";
import type { Timeline } from "../state/timeline";
import { holdsWords } from "../state/turns";
import { WorkProgress } from "../ui/work_progress";
import { CheckChart } from "./check_chart";
import { type AskedCheck, heldBars } from "./use_check_course";

interface Props {
  asked: AskedCheck;
  course: CheckCourse;
  work: BagWork<CheckCourse>;
  threshold: Signal<number>;
  timeline: Timeline;
  children: ComponentChildren;
}

/** A check over a recording: its values, its threshold, when it held, and that in words. */
export function CourseChart({ asked, course, work, threshold, timeline, children }: Props) {
  const { check, condition } = asked;
  // The values do not depend on the threshold: they are drawn once.
  const values = useMemo(() => course, [asked]);
  const { kind } = work.state.value;
  return (
    <>
      <CheckChart
        {...{ timeline, values, threshold }}
        label={`Value of ${check.topic} ${check.property}`}
        bars={heldBars(course, condition)}
        isBusy={kind === "running"}
      >
        {children}
      </CheckChart>
      {kind === "failed" ? (
        <WorkProgress work={work} doing="" />
      ) : (
        <p role="status">
          {kind === "running"
            ? `Asking what ${threshold.value} would do …`
            : `${check.op} ${threshold.value}: ${holdsWords(course.condition.turns, course.duration_s)}.`}
        </p>
      )}
      {course.notices.map((notice) => (
        <p key={notice} class="quiet">
          {notice}
        </p>
      ))}
    </>
  );
}
