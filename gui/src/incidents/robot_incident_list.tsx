// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { FetchState, IncidentsOfRobot, RobotIncident } from "../api/types";
import { href } from "../route";
import type { RobotIncidents } from "../state/robot_incidents";
import { Button } from "../ui/button";
import { ColumnHeads } from "../ui/data_table";
import { Problem } from "../ui/notice";
import { counted, readable, sizeWords } from "../ui/numbers";
import { NeedsServer } from "../ui/server_gone";
import { SUMMARY_COLUMNS, SummaryCells } from "./incident_table";

/** What the robots on the link recorded: listed at once, fetched one by one. Nothing without a link. */
export function RobotIncidentList({ robots }: { robots: RobotIncidents }) {
  const answer = robots.answer.value;
  const problem = robots.problem.value;
  if (answer?.is_linked === false) return null;
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

const COLUMNS = [...SUMMARY_COLUMNS, "In the project"];

function OfRobot({ robots, one: { robot, problem, incidents } }: { robots: RobotIncidents; one: IncidentsOfRobot }) {
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
              <RobotRow key={incident.name} {...{ robots, robot, incident }} />
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
  incident: RobotIncident;
}

function RobotRow({ robots, robot, incident }: RowProps) {
  const { summary, size_kb } = incident;
  return (
    <tr>
      <th scope="row">{summary.title}</th>
      <SummaryCells {...{ summary, size_kb }} />
      <td data-label="In the project">
        <FetchCell {...{ robots, robot, incident }} />
      </td>
    </tr>
  );
}

function FetchCell({ robots, robot, incident: { name, kept, summary } }: RowProps) {
  const fetch = robots.of(robot, name);
  const here = fetch?.kept ?? kept;
  if (here !== null) return <a href={href({ page: "incidents", name: here })}>Open it</a>;
  if (fetch?.state === "running") {
    return <Running fetch={fetch} title={summary.title} cancel={() => void robots.cancel(robot, name)} />;
  }
  const word = fetch?.state === "cancelled" ? "Go on" : "Fetch";
  return (
    <div>
      <NeedsServer changes>
        <Button
          label={word}
          class="small"
          aria-label={`${word}: ${summary.title} of ${robot}`}
          onClick={() => void robots.fetch(robot, name)}
        />
      </NeedsServer>
      {fetch?.state === "cancelled" && (
        <span class="quiet"> Cancelled. {sizeWords(fetch.got_kb)} are here already.</span>
      )}
      {fetch?.state === "failed" && <Problem text={fetch.problem} />}
    </div>
  );
}

function Running({ fetch, title, cancel }: { fetch: FetchState; title: string; cancel: () => void }) {
  const { got_kb, total_kb, rate_kb_per_s, level_hz, problem } = fetch;
  return (
    <div class="fetching">
      <progress max={1} value={total_kb > 0 ? got_kb / total_kb : 0} aria-label={`Fetching ${title}`} />
      <NeedsServer changes>
        <Button label="Cancel" class="small" onClick={cancel} />
      </NeedsServer>
      <span class="quiet">
        {sizeWords(got_kb)} of {sizeWords(total_kb)}, {readable(rate_kb_per_s)} KB/s
        {level_hz !== null && `; all topics are here at ${readable(level_hz)} Hz`}
        {problem && `; waits: ${problem}`}
      </span>
    </div>
  );
}
