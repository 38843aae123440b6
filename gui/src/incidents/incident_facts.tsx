// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { IncidentAnswer, IncidentRecord } from "../api/types";
import { href } from "../route";
import { DataTable } from "../ui/data_table";
import { counted, moment, NS_PER_MS, readable, sizeWords } from "../ui/numbers";
import { furtherWords, missingWords, sinceTrigger, sumOf, valueWords, windowWords } from "./missing_words";

/** Why an incident was recorded, and what is missing of it. */
export function IncidentFacts({ incident }: { incident: IncidentAnswer }) {
  const { record, units } = incident;
  const messages = sumOf(record.topics, "messages");
  const values = valueWords(record.values, units);
  const further = furtherWords(record, units);
  return (
    <>
      <p class="headline">
        The rule <strong>{record.rule}</strong> began to hold at {moment(record.triggered_ns / NS_PER_MS)}.
      </p>
      <dl class="facts">
        <dt>Because</dt>
        <dd>{values.length === 0 ? "its condition reads no values" : values.join(", ")}</dd>
        {further.length > 0 && (
          <>
            <dt>Again</dt>
            <dd>
              <ul class="moments" aria-label="Further moments">
                {further.map((words, place) => (
                  <li key={`${place} ${words}`}>{words}</li>
                ))}
              </ul>
            </dd>
          </>
        )}
        <dt>Rule</dt>
        <dd>
          <RuleLink incident={incident} />
        </dd>
        <dt>Kept</dt>
        <dd>
          {counted(messages, "message")} of {counted(Object.keys(record.topics).length, "topic")},{" "}
          {sizeWords(incident.size_bytes / 1000)}, from {windowWords(record)}
        </dd>
        <dt>Missing</dt>
        <dd>
          {record.missing.length === 0 ? (
            "nothing"
          ) : (
            <ul class="missing" aria-label="Missing">
              {missingWords(record.missing, record.triggered_ns).map((words) => (
                <li key={words}>{words}</li>
              ))}
            </ul>
          )}
        </dd>
        <dt>Folder</dt>
        <dd class="path">{incident.name}</dd>
      </dl>
    </>
  );
}

/** Where the rule stands: in a file of the project, if it has that. */
function RuleLink({ incident: { rule_file, is_same_text, record } }: { incident: IncidentAnswer }) {
  const { rule, file, line } = record;
  if (rule_file === null) {
    return (
      <>
        line {line} of <code>{file}</code>, which is not in this project
      </>
    );
  }
  return (
    <>
      <a href={href({ page: "rules", name: rule_file, ...(is_same_text ? { line: String(line) } : {}) })}>
        {rule} in {rule_file}
      </a>
      , line {line}
      {!is_same_text && <span class="quiet"> (the file is another one now than when this was recorded)</span>}
    </>
  );
}

/** What an incident holds of each topic. */
export function RecordedTopics({ record }: { record: IncidentRecord }) {
  return (
    <section aria-label="Topics">
      <h2>Topics</h2>
      <DataTable
        label="Topics"
        heads={["Topic", "Messages", "Size"]}
        rows={Object.entries(record.topics).map(([topic, { type, messages, bytes }]) => [
          <>
            {topic}
            <div class="quiet">{type || "not published"}</div>
          </>,
          <>
            {readable(messages)}
            <Latched record={record} topic={topic} />
          </>,
          sizeWords(bytes / 1000),
        ])}
      />
    </section>
  );
}

/** How much came before the window and still counted in it. */
function Latched({ record, topic }: { record: IncidentRecord; topic: string }) {
  const latched = record.latched.filter((one) => one.topic === topic);
  const [first] = latched;
  if (!first) return null;
  const came =
    latched.length === 1 ? `came ${sinceTrigger(first.stamp_ns, record.triggered_ns)}` : "from before the window";
  return (
    <div class="quiet">
      {readable(latched.length)} still valid, {came}
    </div>
  );
}
