// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Finding, Severity } from "../api/types";
import { href } from "../route";
import type { RuleEditor } from "../state/rule_editor";

const MARKS: Record<Severity, string> = { error: "Error", warning: "Warning", info: "Note" };

/** Everything the checker says, each with the way there and the fix. */
export function FindingsPanel({ editor }: { editor: RuleEditor }) {
  const findings = editor.findings.value;
  return (
    <>
      <p class="visually-hidden" role="status" aria-live="polite">
        {findings.length === 0 ? "No findings" : `${findings.length} findings`}
      </p>
      {findings.length === 0 && <p class="quiet">No findings: the rules can be used as they are.</p>}
      <ul class="findings" aria-label="Findings">
        {findings.map((finding) => (
          <FindingRow key={`${finding.code} ${finding.offset} ${finding.index}`} {...{ editor, finding }} />
        ))}
      </ul>
    </>
  );
}

function FindingRow({ editor, finding }: { editor: RuleEditor; finding: Finding }) {
  const { offset, end_offset, fix } = finding;
  const related = finding.related.map((id) => editor.statement(id)).filter((each) => each !== undefined);
  return (
    <li class={finding.severity}>
      <span class="mark">{MARKS[finding.severity]}</span>
      <button
        type="button"
        class="link"
        title="Show in the text"
        onClick={() => (editor.spot.value = { offset, end_offset, from: "findings" })}
      >
        line {finding.line}
      </button>
      <span class="message">
        {finding.message}
        {finding.hint && <span class="quiet"> {finding.hint}</span>}
      </span>
      {related.map((statement) => (
        <button
          key={statement.id}
          type="button"
          class="small"
          onClick={() =>
            (editor.spot.value = {
              offset: statement.offset ?? 0,
              end_offset: statement.end_offset ?? 0,
              from: "findings",
            })
          }
        >
          Show line {statement.line}
        </button>
      ))}
      {fix && (
        <button type="button" class="small fix" onClick={() => void editor.fix(finding)}>
          {fix.title}
        </button>
      )}
      {finding.code === "tier-without-rate" && (
        <a href={href({ page: "topics", name: "profile.toml" })}>Topic parameters</a>
      )}
      <code class="quiet">{finding.code}</code>
    </li>
  );
}
