// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from "preact/hooks";
import type { Problem } from "../api/types";
import { RULES_WORDS } from "../state/robot_link";
import type { RulePush, Stage } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { Button } from "../ui/button";
import { FormDialog } from "../ui/dialog";
import { sentence } from "../ui/numbers";

type Kept = Extract<Stage, { kind: "kept" }>;
type Trying = Extract<Stage, { kind: "trying" }>;

/** How far sent rules are: checked by the robot, tried there, kept; or why they are not. */
export function RulePushSteps({ rulePush, editor }: { rulePush: RulePush; editor: RuleEditor }) {
  const host = useRef<HTMLDivElement>(null);
  const { kind } = rulePush.stage.value;
  const isShown = kind !== "idle" && kind !== "asking" && kind !== "asked";
  // From the dialog on, the keyboard goes on here; not on a button, which a second Enter would press.
  useEffect(() => {
    if (isShown) host.current?.focus();
  }, [isShown]);
  return (
    <div ref={host} tabIndex={-1} class="rule-push-host">
      <StageView rulePush={rulePush} editor={editor} />
    </div>
  );
}

function StageView({ rulePush, editor }: { rulePush: RulePush; editor: RuleEditor }) {
  const stage = rulePush.stage.value;
  switch (stage.kind) {
    case "sending":
      return <Steps done={0} words={`Sent to ${stage.node}, which is checking the rules …`} leftS={null} />;
    case "trying":
      return <TryingSteps rulePush={rulePush} stage={stage} />;
    case "kept":
      if (!rulePush.isHeard.value) return <NoStatus words={`${stage.node} kept the rules that were sent to it`} />;
      return <KeptSteps rulePush={rulePush} stage={stage} />;
    case "written":
      return (
        <Steps
          done={4}
          words={`${stage.node} keeps these rules, and wrote them to its file ${stage.file}. What that held is beside it, in ${stage.previousFile}.`}
          leftS={null}
        />
      );
    case "replaced":
      return (
        <p class="notice warning" role="status">
          {stage.node} no longer follows the rules that were sent to it. {RULES_WORDS[stage.by]}
        </p>
      );
    case "gone":
      return (
        <p class="notice warning" role="status">
          The rules were not kept in time: {stage.node} returned to its previous rules.
        </p>
      );
    case "refused":
      return <Refusal outcome={stage.outcome} problem={stage.problem} editor={editor} />;
    default:
      return null;
  }
}

function TryingSteps({ rulePush, stage }: { rulePush: RulePush; stage: Trying }) {
  const leftS = rulePush.leftS.value;
  if (!rulePush.isHeard.value) {
    return <NoStatus words={`${stage.node} tried the rules, and reverts them unless they were kept`} />;
  }
  if (stage.isLetGo) {
    return (
      <p role="status">
        {stage.node} returns to its previous rules within {stage.withinS} s.
      </p>
    );
  }
  return (
    <div class="rule-push">
      <Steps
        done={1}
        words={`${stage.node} follows these rules. Unless you keep them, it returns to its previous rules.`}
        leftS={leftS}
      />
      <Button label="Keep these rules" class="primary" onClick={() => void rulePush.keep()} />
      <Button label="Do not keep them" onClick={() => rulePush.letGo()} />
      <progress aria-label="Time left to keep the rules" max={stage.withinS} value={leftS} />
    </div>
  );
}

/** What *kept* lasts for, and the way to make it last. */
function KeptSteps({ rulePush, stage }: { rulePush: RulePush; stage: Kept }) {
  const { node, lasting } = stage;
  useEffect(() => {
    if (lasting === null) void rulePush.askLasting();
  }, [lasting]);
  const files = lasting?.files.map((each) => `‘${each}’`).join(", ");
  const until = files
    ? `until its runtime ends or its file ${files} changes; then that is back`
    : "until its runtime ends";
  return (
    <div class="rule-push">
      <Steps
        done={3}
        words={lasting === null ? `${node} keeps these rules.` : `${node} keeps these rules ${until}.`}
        leftS={null}
      />
      {lasting !== null && (
        <>
          <Button
            label="Write to its file"
            disabled={lasting.writable_file === ""}
            aria-describedby={lasting.why_not ? "why-not-written" : undefined}
            onClick={() => void rulePush.write()}
          />
          {lasting.why_not && (
            <p class="quiet" id="why-not-written">
              {lasting.why_not}
            </p>
          )}
        </>
      )}
    </div>
  );
}

/** What is known of rules on a robot that sends no status. */
function NoStatus({ words }: { words: string }) {
  return (
    <p class="notice warning" role="status">
      {words}. Which rules it follows now is not known: it sends no status.
    </p>
  );
}

function Steps({ done, words, leftS }: { done: number; words: string; leftS: number | null }) {
  const names = ["Checked", leftS === null ? "Trial" : `Trial for ${leftS} s`, "Kept", "Written to its file"];
  return (
    <>
      <ol class="steps" aria-label="Sending the rules">
        {names.map((name, at) => (
          <li key={at} class={at < done ? "done" : ""} aria-current={at === done ? "step" : undefined}>
            <span aria-hidden="true">{at < done ? "✓" : at + 1}</span> {name}
            {at < done && <span class="visually-hidden">, done</span>}
          </li>
        ))}
      </ol>
      <p role="status">{words}</p>
    </>
  );
}

/** What failed and why, when rules were sent or kept; the places in the text are links. */
function Refusal({ outcome, problem, editor }: { outcome: string; problem: Problem; editor: RuleEditor }) {
  const line = lineOf(problem);
  return (
    <div class="notice error column" role="alert">
      <p>
        <strong>{outcome}</strong> {sentence(problem.message)}
        {problem.remedy && `. ${problem.remedy}`}
      </p>
      {problem.findings.map((finding) => (
        <p key={`${finding.line} ${finding.column} ${finding.code}`}>
          <LineLink line={finding.line} editor={editor} /> {sentence(finding.message)}
        </p>
      ))}
      {problem.findings.length === 0 && line !== null && <LineLink line={line} editor={editor} />}
    </div>
  );
}

function LineLink({ line, editor }: { line: number; editor: RuleEditor }) {
  return <Button label={`line ${line}`} class="link" onClick={() => showLine(editor, line)} />;
}

/** The line in a robot's message, as in `rules_text:2:5`. */
function lineOf({ place, message }: Problem): number | null {
  const named = /:(\d+):\d+/.exec(`${place} ${message}`)?.[1];
  return named === undefined ? null : Number(named);
}

function showLine(editor: RuleEditor, line: number): void {
  const lines = editor.text.peek().split("\n");
  const offset = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0);
  const end = offset + (lines[line - 1]?.length ?? 0);
  editor.spot.value = { offset, end_offset: end, from: "findings" };
}

/** What would change on the robot, before anything is sent. */
export function SendDialog({ rulePush }: { rulePush: RulePush }) {
  const stage = rulePush.stage.value;
  if (stage.kind !== "asked") return null;
  const { preview, node } = stage;
  // Sending closes the dialog, too, and the stage of that must stay.
  const close = () => rulePush.stage.peek() === stage && rulePush.close();
  if (preview.same) {
    return (
      <FormDialog title={`Send to ${node}`} submit="Close" isNotice onSubmit={close} onClose={close}>
        <p>The robot already has these rules. Comments and layout of the text are not sent.</p>
      </FormDialog>
    );
  }
  return (
    <FormDialog title={`Send to ${node}`} submit="Send" onSubmit={() => rulePush.send()} onClose={close}>
      <p>This changes on the robot:</p>
      <ul class="differences" aria-label="Differences">
        {preview.differences.map((difference) => (
          <li key={difference}>{difference}</li>
        ))}
      </ul>
      <p class="quiet">
        The robot checks the rules and tries them. It returns to its previous rules unless you keep them.
      </p>
    </FormDialog>
  );
}
