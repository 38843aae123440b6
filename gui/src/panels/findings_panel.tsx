// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import type { PlacedFinding, Severity } from "../api/types";
import { statementTitle, withoutLines } from "../blocks/rule_words";
import { DOCUMENTATION_TAB, findingHref } from "../documentation";
import { href } from "../route";
import type { ProfileRepair } from "../state/profile_repair";
import type { RuleEditor } from "../state/rule_editor";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { Notice } from "../ui/notice";
import { clock, counted, sentence } from "../ui/numbers";
import { ownProfile, ProfileChangeNotice } from "./profile_choice";

const MARKS: Record<Severity, string> = { error: "Error", warning: "Warning", info: "Note" };
const SEVERITIES = ["error", "warning", "info"] as const;

/** How many findings are shown at first: a list of hundreds is read from its top. */
const SHOWN = 50;

/** Findings that topic parameters can end, and no button alone: somebody has to say a number or a name. */
const OF_TOPIC_PARAMETERS: ReadonlySet<string> = new Set([
  "tier-without-rate",
  "unnamed-in-profile",
  "not-measured",
  "record-unpublished",
  "no-margin",
  "profile-incomplete",
  "budget-not-proven",
]);

/** Everything the checker says, each with the way there and the fix. */
export function FindingsPanel({ editor, repair }: { editor: RuleEditor; repair: ProfileRepair }) {
  const all = editor.findings.value;
  const [only, setOnly] = useState<Severity | null>(null);
  const limited = all.filter(({ severity }) => severity === only);
  // What is mended last of its kind leads back to the others.
  const findings = limited.length > 0 ? limited : all;
  const isGone = useRobot().isServerGone.value;
  const [limit, setLimit] = useState(SHOWN);
  const counts = SEVERITIES.map((each) => ({ each, count: all.filter(({ severity }) => severity === each).length }));
  const kinds = counts.filter(({ count }) => count > 0);
  const hidden = findings.length - limit;
  if (!editor.isChecked.value) return <p class="quiet">Checking the rules …</p>;
  return (
    <>
      <p class="visually-hidden" role="status" aria-live="polite">
        {all.length === 0 ? "No findings" : counted(all.length, "finding")}
      </p>
      {editor.tooLong.value && <Notice kind="warning" text={editor.tooLong.value} />}
      <ProfileChangeNotice repair={repair} />
      {isGone && (
        <p class="quiet">
          As of {clock(editor.checkedMs.value)}: what changed since is checked when the server is back.
        </p>
      )}
      {kinds.length > 1 && (
        <div class="row" role="group" aria-label="Limit the findings">
          <Button label="All" class="small" aria-pressed={findings === all} onClick={() => setOnly(null)} />
          {kinds.map(({ each, count }) => (
            <Button
              key={each}
              label={counted(count, MARKS[each].toLowerCase())}
              class="small"
              aria-pressed={findings === limited && only === each}
              onClick={() => setOnly(each)}
            />
          ))}
        </div>
      )}
      {findings.length === 0 && !isGone && <p class="quiet">No findings: the rules can be used as they are.</p>}
      <ul class="findings" aria-label="Findings">
        {findings.slice(0, limit).map((finding, row) => (
          // Places and lines change with each key above: a row is written anew, and not made anew.
          <FindingRow key={row} {...{ editor, repair, finding }} />
        ))}
      </ul>
      {hidden > 0 && (
        <Button
          label={`Show ${Math.min(hidden, 5 * SHOWN)} more of ${hidden}`}
          class="small"
          onClick={() => setLimit(limit + Math.min(hidden, 5 * SHOWN))}
        />
      )}
    </>
  );
}

function FindingRow(props: { editor: RuleEditor; repair: ProfileRepair; finding: PlacedFinding }) {
  const { editor, repair, finding } = props;
  const { fix, profile_fix } = finding;
  const profile = editor.profile.value?.name;
  const own = editor.statement(finding.statement);
  const related = finding.related.map((id) => editor.statement(id)).filter((each) => each !== undefined);
  const title = (own && statementTitle(own)) ?? "All rules";
  const words = (said: string) => sentence(withoutLines(said, editor.statements.value));
  const show = (offset = 0, end_offset = 0) => (editor.spot.value = { offset, end_offset, from: "findings" });
  return (
    <li class={finding.severity}>
      <span class="mark">{MARKS[finding.severity]}</span>
      <Button
        label={title}
        class="link"
        title={`Show in text and blocks: line ${finding.line}`}
        onClick={() => show(finding.offset, finding.end_offset)}
      />
      <span class="message">
        {words(finding.message)}
        {finding.hint && <span class="quiet"> {words(finding.hint)}</span>}
      </span>
      {related.length > 0 && (
        <span class="pair" role="group" aria-label="Other statements that this is about">
          {related.map((statement) => (
            <Button
              label={`Show ${statementTitle(statement)}${statementTitle(statement) === title ? ", the other one" : ""}`}
              key={statement.id}
              class="small"
              onClick={() => show(statement.offset, statement.end_offset)}
            />
          ))}
        </span>
      )}
      <NeedsServer>
        {fix && <Button label={fix.title} class="small fix" onClick={() => void editor.fix(finding)} />}
        {profile_fix && profile !== undefined && (
          <NeedsServer changes>
            <Button
              label={`${profile_fix.title}, in ${profile}`}
              class="small fix"
              title={`Changes ${profile_fix.key} in ${profile}`}
              onClick={() => void editor.attempt(() => repair.mend(profile_fix))}
            />
          </NeedsServer>
        )}
      </NeedsServer>
      {(OF_TOPIC_PARAMETERS.has(finding.code) || (profile_fix && profile === undefined)) && (
        <a href={href({ page: "topics", name: profile ?? ownProfile(editor.name), rules: editor.name })}>
          Topic parameters
        </a>
      )}
      <a class="why" target={DOCUMENTATION_TAB} title={finding.code} href={findingHref(finding.code)}>
        Why?
      </a>
    </li>
  );
}
