// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type RobotLink, RULES_WORDS } from "../state/robot_link";
import type { RobotRules, RulePush } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { checkOfRobot, writeThreshold } from "../state/written_checks";
import { Choice } from "../ui/choice";
import { useRobot } from "../ui/connection";
import { later } from "../ui/later";
import type { Propose } from "./robot_past";
import { RobotTopics, RobotTotals } from "./robot_view";
import { RulePushSteps } from "./rule_push_steps";

const RobotPast = later(async () => (await import("./robot_past")).RobotPast);

/** The running robot: what it relays now, and whether it follows the open rules. */
export function RobotPanel(props: { editor: RuleEditor; robotRules: RobotRules; rulePush: RulePush }) {
  const link = useRobot();
  const live = link.live.value;
  return (
    <div class="robot">
      <RulePushSteps rulePush={props.rulePush} editor={props.editor} />
      <div class="row">
        <RobotChoice link={link} />
        <p>
          <Situation link={link} />
        </p>
        <RulesNotice robotRules={props.robotRules} />
      </div>
      {live && <RobotTotals live={live} />}
      {live && <RobotTopics link={link} live={live} />}
      {link.robot.value && (
        <RobotPast
          api={props.editor.api}
          node={link.robot.value.node}
          propose={props.robotRules.comparison.value.kind === "same" ? proposeIn(props.editor) : null}
        />
      )}
      {!live && link.connection.value.kind === "connected" && <p class="quiet">Waiting for a status …</p>}
    </div>
  );
}

/** Writes the threshold of a robot's check into the open rules. */
function proposeIn(editor: RuleEditor): Propose {
  return (told, threshold) =>
    void writeThreshold(
      editor,
      threshold,
      (statements) => checkOfRobot(statements, told),
      "The open rules do not have exactly one such check",
    );
}

function RobotChoice({ link }: { link: RobotLink }) {
  const robots = link.robots.value?.robots ?? [];
  if (robots.length === 0) return null;
  return (
    <Choice
      label="Robot"
      value={link.node.value ?? ""}
      choices={robots.map(({ node, label, is_heard }) => [node, is_heard ? label : `${label} (silent)`] as const)}
      choose={(node) => link.choose(node)}
    />
  );
}

function Situation({ link }: { link: RobotLink }) {
  const { kind, words, why, trouble } = link.connection.value;
  const robot = link.robot.value;
  if (kind !== "connected" || robot === null) {
    return (
      <>
        <strong>{words}.</strong> {why}
      </>
    );
  }
  const { origin } = robot.rules;
  return (
    <>
      {origin !== "fallback" && RULES_WORDS[origin]}{" "}
      {trouble && (
        <span class="problem" role="alert">
          {trouble}
        </span>
      )}
    </>
  );
}

function RulesNotice({ robotRules }: { robotRules: RobotRules }) {
  const comparison = robotRules.comparison.value;
  switch (comparison.kind) {
    case "none":
      return null;
    case "same":
      return <p class="quiet">The robot follows these rules: the blocks show their current state there.</p>;
    case "other":
      return (
        <details>
          <summary>The robot has other rules, so the blocks do not show the state there.</summary>
          <ul>
            {comparison.preview.differences.map((difference) => (
              <li key={difference}>{difference}</li>
            ))}
          </ul>
        </details>
      );
    case "unclear":
      return <p class="quiet">These rules cannot be compared with the robot's. {comparison.why}</p>;
  }
}
