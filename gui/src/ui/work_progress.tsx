// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { BagWork } from "../state/bag_work";
import { Button } from "./button";
import { Problem } from "./notice";

/** How far work on a recording is, and the button that ends it; or why it failed. */
export function WorkProgress<T>({ work, doing }: { work: BagWork<T>; doing: string }) {
  const state = work.state.value;
  if (state.kind === "failed") {
    return <Problem text={state.why} />;
  }
  if (state.kind === "idle") return <p role="status">{state.note}</p>;
  if (state.kind !== "running") return null;
  return (
    <div class="row work">
      <span role="status">{doing} …</span>
      <progress max={1} value={state.share} aria-label={doing} />
      <span class="number">{Math.round(100 * state.share)} %</span>
      <Button label="Cancel" onClick={() => work.cancel()} />
    </div>
  );
}
