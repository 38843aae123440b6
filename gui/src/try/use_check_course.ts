// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { CheckCondition, CheckCourse, Condition } from "../api/types";
import { BagWork } from "../state/bag_work";
import { withValue } from "../state/written_checks";
import type { HeldBar } from "./check_chart";

const ASK_AFTER_MS = 300;

/** A check, the `For` and `Within` around it, and the recording that it is compared with. */
export interface AskedCheck {
  bag: string;
  check: CheckCondition;
  condition: Condition;
  profileText: string | null;
}

/** What the check of `asked` would read and when it would hold with another threshold; null until that is known. */
export function useCheckCourse(
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
        const condition = withValue(asked.condition, asked.check, threshold);
        return api.ask(
          "POST /api/check/course",
          { bag: asked.bag, condition, profile_text: asked.profileText, run },
          { signal },
        );
      });
    // Who drags is answered once the line rests.
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
export function heldBars(course: CheckCourse, condition: Condition): HeldBar[] {
  const label = "The check without its time";
  return [
    { label: "The condition", turns: course.condition.turns },
    ...(condition.kind === "timed" ? [{ label, turns: course.check.turns, words: `${label}:` }] : []),
  ];
}
