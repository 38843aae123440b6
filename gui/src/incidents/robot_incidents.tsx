// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { signal } from "@preact/signals";
import { type Api, refusalOf } from "../api/client";
import type { FetchesAnswer, FetchState, IncidentsOfRobot, RemoteIncident, RobotIncidentsAnswer } from "../api/types";
import { href } from "../route";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { ColumnHeads } from "../ui/data_table";
import { Problem } from "../ui/notice";
import { counted, readable, sizeWords } from "../ui/numbers";
import { SUMMARY_COLUMNS, SummaryCells } from "./incident_table";

/** What the robots recorded: over a link listed at once, and fetched one by one; else how many, and how to get them. */
export function RobotIncidentList({ robots }: { robots: RobotIncidents }) {
  const answer = robots.answer.value;
  const problem = robots.problem.value;
  if (answer?.is_linked === false) return <OnDisks />;
  return (
    <section class="on-robots" aria-label="On robots">
      <h2>On robots</h2>
      <Problem text={problem} />
      {answer === null && !problem && <p class="quiet">Asking the robots …</p>}
      {answer?.problem && <p class="problem">{answer.problem}</p>}
      {answer && !answer.problem && answer.robots.length === 0 && <p class="quiet">No robot is heard over the link.</p>}
      {answer?.robots.map((one) => (
        <OfRobot key={one.robot} {...{ robots, one }} />
      ))}
    </section>
  );
}

/** Over ROS a robot says only how many there are. */
function OnDisks() {
  const some = useRobot().robots.value?.robots.filter(({ recorded }) => recorded > 0) ?? [];
  if (some.length === 0) return null;
  return (
    <section class="on-robots" aria-label="On robots">
      <h2>On robots</h2>
      {some.map(({ node, label, recorded }) => (
        <p key={node}>
          {counted(recorded, "incident")} {recorded === 1 ? "is" : "are"} on the disk of <strong>{label}</strong>.
        </p>
      ))}
      <p class="quiet">
        Over ROS incidents do not come here. Copy the folder that its <code>testudo run --incidents</code> names into
        this project; or start the robot with <code>--link</code> and this page with{" "}
        <code>testudo ruler --connect</code>, which lists and fetches them here.
      </p>
    </section>
  );
}

const COLUMNS = [...SUMMARY_COLUMNS, "In the project"];

function OfRobot({
  robots,
  one: { robot, problem, incidents, kept },
}: {
  robots: RobotIncidents;
  one: IncidentsOfRobot;
}) {
  if (problem) {
    return (
      <p>
        <strong>{robot}</strong>: <span class="problem">{problem}</span>
      </p>
    );
  }
  if (incidents.length === 0) {
    return (
      <p>
        <strong>{robot}</strong>: <span class="quiet">no incidents</span>
      </p>
    );
  }
  return (
    <>
      <h3>
        {robot} <span class="quiet">{counted(incidents.length, "incident")}</span>
        {!robots.heard.value.includes(robot) && <span class="quiet">, not heard now</span>}
      </h3>
      <div class="table-scroll">
        <table class="robot-table incident-table" aria-label={`Incidents on ${robot}`}>
          <ColumnHeads names={COLUMNS} />
          <tbody>
            {incidents.map((incident) => (
              <RobotRow key={incident.name} {...{ robots, robot, incident }} kept={kept[incident.name] ?? null} />
            ))}
          </tbody>
        </table>
      </div>
    </>
  );
}

interface RowProps {
  robots: RobotIncidents;
  robot: string;
  incident: RemoteIncident;
  /** What the project calls it, where it was fetched. */
  kept: string | null;
}

function RobotRow(props: RowProps) {
  return (
    <tr>
      <th scope="row">{props.incident.label}</th>
      <SummaryCells incident={props.incident} />
      <td data-label="In the project">
        <FetchCell {...props} />
      </td>
    </tr>
  );
}

function FetchCell({ robots, robot, incident: { name, label }, kept }: RowProps) {
  const fetch = robots.of(robot, name);
  const here = fetch?.kept ?? kept;
  if (here !== null) return <a href={href({ page: "incidents", name: here })}>Open it</a>;
  if (fetch?.state === "running") {
    return <Running fetch={fetch} title={label} cancel={() => void robots.cancel(robot, name)} />;
  }
  const word = fetch?.state === "cancelled" ? "Go on" : "Fetch";
  return (
    <div>
      <NeedsServer changes>
        <Button
          label={word}
          class="small"
          aria-label={`${word}: ${label} of ${robot}`}
          onClick={() => void robots.fetch(robot, name)}
        />
      </NeedsServer>
      {fetch?.state === "cancelled" && (
        <span class="quiet"> Cancelled. {sizeWords(fetch.progress.got_bytes / 1000)} are here already.</span>
      )}
      {fetch?.state === "failed" && <Problem text={fetch.problem} />}
    </div>
  );
}

function Running({ fetch, title, cancel }: { fetch: FetchState; title: string; cancel: () => void }) {
  const { got_bytes, total_bytes, rate_bytes_per_s, level_hz, waits_for } = fetch.progress;
  return (
    <div class="fetching">
      <progress max={1} value={total_bytes > 0 ? got_bytes / total_bytes : 0} aria-label={`Fetching ${title}`} />
      <NeedsServer changes>
        <Button label="Cancel" class="small" onClick={cancel} />
      </NeedsServer>
      <span class="quiet">
        {sizeWords(got_bytes / 1000)} of {sizeWords(total_bytes / 1000)}, {readable(rate_bytes_per_s / 1000)} KB/s
        {level_hz !== null && `; all topics are here at ${readable(level_hz)} Hz`}
        {waits_for && `; waits: ${waits_for}`}
      </span>
    </div>
  );
}

const FOLLOW_MS = 700;
const LOOK_MS = 2000;

/** The incidents of the robots on the link, and those that are being fetched, which go on without the page. */
export class RobotIncidents {
  /** What each robot answered last, also one that left since. */
  readonly answer = signal<RobotIncidentsAnswer | null>(null);
  readonly heard = signal<readonly string[]>([]);
  readonly fetches = signal<readonly FetchState[]>([]);
  readonly problem = signal("");
  private timer = 0;
  private isOpen = false;
  private isAsking = false;

  constructor(
    private readonly api: Api,
    /** Called when another incident is in the project. */
    private readonly onFetched: () => void,
  ) {}

  /** Asks the robots, those that come later too, and follows what is fetched until the returned function is called. */
  open(): () => void {
    this.isOpen = true;
    void this.ask();
    void this.follow();
    return () => {
      this.isOpen = false;
      window.clearTimeout(this.timer);
    };
  }

  /** Asks the robots once more. */
  async ask(): Promise<void> {
    this.isAsking = true;
    this.problem.value = await refusalOf(async () => {
      const answer = await this.api.ask("GET /api/robot-incidents", null);
      const heard = answer.robots.map(({ robot }) => robot);
      const before = this.answer.peek()?.robots ?? [];
      const left = before.filter(({ robot, incidents }) => incidents.length > 0 && !heard.includes(robot));
      this.heard.value = heard;
      this.answer.value = { ...answer, robots: [...answer.robots, ...left] };
    });
    this.isAsking = false;
  }

  fetch(robot: string, name: string): Promise<void> {
    return this.follow(() => this.api.ask("POST /api/robot-incidents/fetch", { robot, name }));
  }

  cancel(robot: string, name: string): Promise<void> {
    return this.follow(() => this.api.ask("POST /api/robot-incidents/cancel", { robot, name }));
  }

  of(robot: string, name: string): FetchState | null {
    return this.fetches.value.find((one) => one.robot === robot && one.name === name) ?? null;
  }

  private async follow(
    ask: () => Promise<FetchesAnswer> = () => this.api.ask("GET /api/robot-incidents/fetches", null),
  ): Promise<void> {
    this.problem.value = await refusalOf(async () => {
      const before = done(this.fetches.peek());
      const { fetches, heard } = await ask();
      this.fetches.value = fetches;
      if (done(fetches) > before) this.onFetched();
      this.askNew(heard);
    });
    window.clearTimeout(this.timer);
    if (!this.isOpen || this.answer.peek()?.is_linked === false) return;
    const isRunning = this.fetches.peek().some(({ state }) => state === "running");
    this.timer = window.setTimeout(() => void this.follow(), isRunning ? FOLLOW_MS : LOOK_MS);
  }

  /** Asks again where a robot came, or none could be asked: each question costs the link. */
  private askNew(heard: readonly string[]): void {
    if (this.isAsking) return;
    const isNew = heard.some((robot) => !this.heard.peek().includes(robot));
    this.heard.value = heard;
    if (isNew || this.answer.peek()?.problem !== "") void this.ask();
  }
}

function done(fetches: readonly FetchState[]): number {
  return fetches.filter(({ state }) => state === "done").length;
}
