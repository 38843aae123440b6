// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { TryIncident } from "../api/types";
import { missingWords, sumOf, windowWords } from "../incidents/missing_words";
import { href } from "../route";
import type { Keepings } from "../state/keepings";
import type { Trial } from "../state/trial";
import { Button } from "../ui/button";
import { Problem } from "../ui/notice";
import { counted, sizeWords } from "../ui/numbers";
import { NeedsServer } from "../ui/server_gone";

/** What the rules would have recorded of the bag; a time leads there, and each can be kept in the project. */
export function TriedIncidents({ keepings, trial }: { keepings: Keepings; trial: Trial }) {
  const { incidents } = trial.answer;
  if (incidents === null) return null;
  return (
    <section class="tried-incidents" aria-label="What the rules would have recorded">
      <h3>
        What the rules would have recorded{" "}
        {incidents.length > 0 && <span class="quiet">(red on the slider and the charts)</span>}
      </h3>
      <Problem text={keepings.problem.value} />
      {incidents.length === 0 ? (
        <p class="quiet">
          Nothing: no rule with a recording began to hold. One that holds from the start on begins nothing either,
          before it was known not to hold.
        </p>
      ) : (
        <ul>
          {incidents.map((incident) => (
            <TriedIncident key={incident.number} {...{ keepings, trial, incident }} />
          ))}
        </ul>
      )}
    </section>
  );
}

function TriedIncident(props: { keepings: Keepings; trial: Trial; incident: TryIncident }) {
  const { keepings, trial, incident } = props;
  const { t, record } = incident;
  const { rule, topics, missing, moments = 1 } = record;
  const keep = keepings.of(trial, incident.number);
  const name = `${record.name} at ${t.toFixed(1)} s`;
  return (
    <li>
      <div class="row">
        <Button label={`${t.toFixed(1)} s`} class="link" title="Move the time there" onClick={() => trial.goTo(t)} />
        <strong>{record.name}</strong>
        <span>
          by {rule}, {windowWords(record)}: {counted(sumOf(topics, "messages"), "message")},{" "}
          {sizeWords(sumOf(topics, "bytes") / 1000)}
          {moments > 1 && `, ${counted(moments - 1, "further moment")}`}
        </span>
        {(keep === null || keep.state === "failed") && (
          <NeedsServer changes>
            <Button
              label="Keep it"
              class="small"
              onClick={() => void keepings.keep(trial, incident.number, name)}
              aria-label={`Keep it: ${name}`}
            />
          </NeedsServer>
        )}
        {keep?.state === "running" && <span class="quiet">Being kept: {Math.round(100 * keep.share)} %</span>}
        {keep?.kept != null && (
          <span>
            Kept: <a href={href({ page: "incidents", name: keep.kept })}>{keep.kept}</a>
          </span>
        )}
        {keep?.state === "failed" && <span class="problem">{keep.problem}</span>}
      </div>
      <p class="quiet">
        {Object.entries(topics)
          .map(([topic, { messages, bytes }]) => `${topic} ${counted(messages, "message")}, ${sizeWords(bytes / 1000)}`)
          .join("; ")}
      </p>
      {missing.length > 0 && <p class="missing">Missing: {missingWords(missing, record.triggered_ns).join("; ")}.</p>}
    </li>
  );
}
