// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo } from "preact/hooks";
import { BagWork } from "../state/bag_work";

/** Work on a topic of a recording, and what it found while both are still the chosen ones. */
export function useMeasured<T>(topic: string, bag: string) {
  const work = useMemo(() => new BagWork<{ topic: string; bag: string; found: T }>(), []);
  useEffect(() => () => work.cancel(), []);
  const state = work.state.value;
  const isOfThese = state.kind === "done" && state.answer.topic === topic && state.answer.bag === bag;
  return { work, state, found: isOfThese ? state.answer.found : null };
}
