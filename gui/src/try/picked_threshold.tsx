// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { Signal } from "@preact/signals";
import { render } from "preact";
import { useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import { Timeline } from "../state/timeline";
import { Button } from "../ui/button";
import { sizeWords } from "../ui/numbers";
import { WorkProgress } from "../ui/work_progress";
import { CourseChart } from "./course_chart";
import { type AskedCheck, useCheckCourse } from "./use_check_course";

/** A larger recording is read when somebody asks for it. */
const READ_AT_ONCE_BYTES = 300e6;

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
