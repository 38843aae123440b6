// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { KeepState } from "../api/types";
import { href } from "../route";
import type { Keepings } from "../state/keepings";
import { Button } from "./button";
import { NeedsServer, useRobot } from "./connection";

/** Which incidents the server keeps now, and what came of it, on every page until somebody has read it. */
export function KeepingBar({ keepings }: { keepings: Keepings }) {
  const keeps = keepings.keeps.value;
  // What is read by whom may only watch stays for the others.
  const mayEnd = !useRobot().onlyWatches.value;
  if (keeps.length === 0) return null;
  return (
    <section class="keeping-bar" aria-label="Incidents being kept">
      {keeps.map((keep) => (
        <Keeping key={keep.run} keep={keep} end={() => mayEnd && void keepings.end(keep.run)} />
      ))}
    </section>
  );
}

function Keeping({ keep, end }: { keep: KeepState; end: () => void }) {
  const { title, bag, state, share, kept, problem } = keep;
  const what = `${title} of ${bag}`;
  if (state === "running") {
    return (
      <div class="row">
        <span role="status">Keeping {what} …</span>
        <progress max={1} value={share} aria-label={`Keeping ${what}`} />
        <span class="number">{Math.round(100 * share)} %</span>
        <NeedsServer changes>
          <Button label="Cancel" class="small" aria-label={`Cancel keeping ${what}`} onClick={end} />
        </NeedsServer>
      </div>
    );
  }
  return (
    <div class={`row ${state}`}>
      {kept === null ? (
        <span role="alert">
          {what} was not kept: {problem}
        </span>
      ) : (
        <span role="status">
          Kept {what}:{" "}
          <a href={href({ page: "incidents", name: kept })} onClick={end}>
            {kept}
          </a>
        </span>
      )}
      <NeedsServer changes>
        <Button label="Close" class="small" aria-label={`Close: ${what}`} onClick={end} />
      </NeedsServer>
    </div>
  );
}
