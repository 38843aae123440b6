// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { IncidentAnswer, IncidentValue, RecordedTopic } from "../api/types";
import { href } from "../route";
import { DataTable } from "../ui/data_table";
import { counted, readable, sizeWords } from "../ui/numbers";
import { moment } from "../ui/times";
import { missingWords, sinceMoment, windowWords } from "./missing_words";

/** Why an incident was recorded, and what is missing of it. */
export function IncidentFacts({ incident }: { incident: IncidentAnswer }) {
  const { summary, values, missing } = incident;
  return (
    <>
      <p class="headline">
        The rule <strong>{summary.rule}</strong> began to hold at {moment(summary.triggered_ms)}.
      </p>
      <dl class="facts">
        <dt>Because</dt>
        <dd>{values.length === 0 ? "its condition reads no values" : values.map(valueWords).join(", ")}</dd>
        <dt>Rule</dt>
        <dd>
          <RuleLink incident={incident} />
        </dd>
        <dt>Kept</dt>
        <dd>
          {counted(summary.messages, "message")} of {counted(incident.topics.length, "topic")},{" "}
          {sizeWords(incident.size_kb)}, from {windowWords(summary)}
        </dd>
        <dt>Missing</dt>
        <dd>
          {missing.length === 0 ? (
            "nothing"
          ) : (
            <ul class="missing" aria-label="Missing">
              {missingWords(missing).map((words) => (
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

function valueWords({ signal, value, unit }: IncidentValue): string {
  return `${signal} was ${value === null ? "unknown" : `${readable(value)}${unit && ` ${unit}`}`}`;
}

/** Where the rule stands: in a file of the project, if it has that. */
function RuleLink({ incident: { rule_file, rule_path, line, is_same_text, summary } }: { incident: IncidentAnswer }) {
  if (rule_file === null) {
    return (
      <>
        line {line} of <code>{rule_path}</code>, which is not in this project
      </>
    );
  }
  return (
    <>
      <a href={href({ page: "rules", name: rule_file, ...(is_same_text ? { line: String(line) } : {}) })}>
        {summary.rule} in {rule_file}
      </a>
      , line {line}
      {!is_same_text && <span class="quiet"> (the file is another one now than when this was recorded)</span>}
    </>
  );
}

/** What an incident holds of each topic. */
export function RecordedTopics({ topics }: { topics: readonly RecordedTopic[] }) {
  return (
    <section aria-label="Topics">
      <h2>Topics</h2>
      <DataTable
        label="Topics"
        heads={["Topic", "Messages", "Size"]}
        rows={topics.map(({ topic, type, messages, size_kb, latched_s }) => [
          <>
            {topic}
            <div class="quiet">{type || "not published"}</div>
          </>,
          <>
            {readable(messages)}
            {latched_s.length > 0 && <div class="quiet">{latchedWords(latched_s)}</div>}
          </>,
          sizeWords(size_kb),
        ])}
      />
    </section>
  );
}

/** What came before the window and still counted in it. */
function latchedWords(latchedS: readonly number[]): string {
  const came = latchedS.length === 1 ? sinceMoment(latchedS[0] ?? 0) : "from before the window";
  return `${readable(latchedS.length)} still valid, ${latchedS.length === 1 ? `came ${came}` : came}`;
}
