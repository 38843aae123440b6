// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo } from "preact/hooks";
import type { Api } from "../api/client";
import type { KeptIncident, TryIncident } from "../api/types";
import { counted, missingWords, sizeWords, windowWords } from "../incidents/missing_words";
import { href } from "../route";
import { BagWork } from "../state/bag_work";
import type { Trial } from "../state/trial";
import { WorkProgress } from "../ui/work_progress";

/** What the rules would have recorded of the bag; a time leads there, and each can be kept in the project. */
export function TriedIncidents({ api, trial }: { api: Api; trial: Trial }) {
  const { incidents } = trial.answer;
  if (incidents === null) return null;
  return (
    <section class="tried-incidents" aria-label="What the rules would have recorded">
      <h3>
        What the rules would have recorded{" "}
        {incidents.length > 0 && <span class="quiet">(red on the slider and the charts)</span>}
      </h3>
      {incidents.length === 0 ? (
        <p class="quiet">
          Nothing: no rule with a recording began to hold. One that holds from the start on begins nothing either,
          before it was known not to hold.
        </p>
      ) : (
        <ul>
          {incidents.map((incident) => (
            <TriedIncident key={incident.number} {...{ api, trial, incident }} />
          ))}
        </ul>
      )}
    </section>
  );
}

function TriedIncident({ api, trial, incident }: { api: Api; trial: Trial; incident: TryIncident }) {
  const { t, title, rule, topics, missing } = incident;
  const work = useMemo(() => new BagWork<KeptIncident>(), [trial]);
  useEffect(() => () => work.cancel(), [work]);
  const keep = () =>
    work.start((run, signal) => api.keepIncident({ rules: trial.tried, bag: trial.bag }, incident.number, run, signal));
  const state = work.state.value;
  return (
    <li>
      <div class="row">
        <button type="button" class="link" title="Move the time there" onClick={() => trial.goTo(t)}>
          {t.toFixed(1)} s
        </button>
        <strong>{title}</strong>
        <span>
          by {rule}, {windowWords(incident)}: {counted(incident.messages, "message")}, {sizeWords(incident.size_kb)}
        </span>
        {(state.kind === "idle" || state.kind === "failed") && (
          <button
            type="button"
            class="small"
            onClick={() => void keep()}
            aria-label={`Keep it: ${title} at ${t.toFixed(1)} s`}
          >
            Keep it
          </button>
        )}
        {state.kind === "done" && (
          <span role="status">
            Kept: <a href={href({ page: "incidents", name: state.answer.name })}>{state.answer.name}</a>
          </span>
        )}
        <WorkProgress work={work} doing={`Keeping ${title}`} />
      </div>
      <p class="quiet">
        {topics
          .map(({ topic, messages, size_kb }) => `${topic} ${counted(messages, "message")}, ${sizeWords(size_kb)}`)
          .join("; ")}
      </p>
      {missing.length > 0 && <p class="missing">Missing: {missingWords(missing).join("; ")}.</p>}
    </li>
  );
}
