// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { signal } from "@preact/signals";
import { type Api, refusalOf } from "../api/client";
import type { KeepState, KeepsAnswer } from "../api/types";
import { href } from "../route";
import type { Trial } from "../state/trial";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";

/** Which incidents the server keeps now, and what came of it, on every page until somebody has read it. */
export function KeptIncidentsBar({ keptIncidents }: { keptIncidents: KeptIncidents }) {
  const keeps = keptIncidents.keeps.value;
  // A page that may only watch takes nothing away from the others.
  const mayEnd = !useRobot().onlyWatches.value;
  if (keeps.length === 0) return null;
  return (
    <section class="keeping-bar" aria-label="Incidents being kept">
      {keeps.map((keep) => (
        <Keeping key={keep.run} keep={keep} end={() => mayEnd && void keptIncidents.end(keep.run)} />
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

const LOOK_MS = 500;

/** The incidents of tries that the server writes into the project, which goes on though the page is closed. */
export class KeptIncidents {
  readonly keeps = signal<readonly KeepState[]>([]);
  readonly problem = signal("");
  private readonly runs = new WeakMap<Trial, string>();
  private timer = 0;

  constructor(private readonly api: Api) {}

  /** Asks what is being kept, and again until all of that has ended. */
  async follow(ask: () => Promise<KeepsAnswer> = () => this.api.ask("GET /api/try/keeps", null)): Promise<void> {
    window.clearTimeout(this.timer);
    this.problem.value = await refusalOf(async () => {
      this.keeps.value = (await ask()).keeps;
    });
    window.clearTimeout(this.timer);
    const isRunning = this.keeps.peek().some(({ state }) => state === "running");
    if (isRunning) this.timer = window.setTimeout(() => void this.follow(), LOOK_MS);
  }

  keep(trial: Trial, number: number, title: string): Promise<void> {
    const run = this.runOf(trial, number);
    const kept = { ...trial.tried, bag: trial.bag, number, run, title };
    return this.follow(() => this.api.ask("POST /api/try/keep", kept));
  }

  /** Ends one that is running; forgets one that has ended. */
  end(run: string): Promise<void> {
    return this.follow(() => this.api.ask("POST /api/try/keep/cancel", { run }));
  }

  /** How far an incident of a try is kept; null where nobody asked for it. */
  of(trial: Trial, number: number): KeepState | null {
    const run = this.runOf(trial, number);
    return this.keeps.value.find((one) => one.run === run) ?? null;
  }

  private runOf(trial: Trial, number: number): string {
    const run = this.runs.get(trial) ?? `${Date.now()} ${Math.random()}`;
    this.runs.set(trial, run);
    return `${run} ${number}`;
  }
}
