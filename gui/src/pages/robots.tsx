// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useComputed, useSignal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Fallback, Project, RobotSummary } from "../api/types";
import { RobotStart } from "../panels/project_start";
import { RobotHistory, RobotTopics, RobotTotals } from "../panels/robot_view";
import { href } from "../route";
import {
  age,
  byTrouble,
  duration,
  inOrderOf,
  isOverBudget,
  linkWords,
  OLD_MS,
  rulesFor,
  troubleOf,
} from "../state/robot_trouble";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { ColumnHeads } from "../ui/data_table";
import { baseName } from "../ui/files";
import { Header } from "../ui/header";
import { later } from "../ui/later";
import { Problem } from "../ui/notice";
import { readable } from "../ui/numbers";
import type { PageProps } from "./page_props";

const RobotChecks = later(async () => (await import("../panels/robot_checks")).RobotChecks);

/** All robots that are heard, or, with a name, that robot without any rules beside it. */
export function RobotsPage({ api, project, refresh, name }: PageProps) {
  return name === "" ? <AllRobots project={project} /> : <OneRobot {...{ api, project, refresh }} node={name} />;
}

function AllRobots({ project }: { project: Project }) {
  const link = useRobot();
  const onlyTrouble = useSignal(false);
  /** The order in which rows stay while somebody is about to choose one. */
  const held = useSignal<string[] | null>(null);
  const robots = useComputed(() => {
    const all = link.robots.value?.robots ?? [];
    return held.value === null ? byTrouble(all) : inOrderOf(held.value, all);
  });
  const troubled = useComputed(() => robots.value.filter((robot) => troubleOf(robot) !== null));
  const timer = useRef(0);
  const hold = (forMs?: number) => {
    held.value ??= robots.peek().map(({ node }) => node);
    window.clearTimeout(timer.current);
    if (forMs !== undefined) timer.current = window.setTimeout(release, forMs);
  };
  const release = () => {
    window.clearTimeout(timer.current);
    held.value = null;
  };
  const shown = onlyTrouble.value ? troubled.value : robots.value;
  return (
    <>
      <Header title="Robots">
        <a href={href({ page: "incidents", name: "" })}>Incidents</a>
      </Header>
      <main class="robots">
        {robots.value.length === 0 ? (
          <p class="quiet">{link.connection.value.why}</p>
        ) : (
          <>
            <div class="row">
              <p role="status">{counted(robots.value.length, troubled.value.length)}</p>
              <label>
                <input
                  type="checkbox"
                  checked={onlyTrouble.value}
                  onChange={(event) => (onlyTrouble.value = event.currentTarget.checked)}
                />
                Only those with trouble
              </label>
            </div>
            {shown.length === 0 && <p class="quiet">No robot is in trouble.</p>}
            {shown.length > 0 && (
              <RobotTable robots={shown} project={project} robotsAgeS={link.robotsAgeS.value} {...{ hold, release }} />
            )}
          </>
        )}
      </main>
    </>
  );
}

function counted(all: number, troubled: number): string {
  const robots = all === 1 ? "1 robot" : `${all} robots`;
  return troubled === 0 ? `${robots}, no trouble` : `${robots}, ${troubled} with trouble`;
}

function OneRobot({ node, ...props }: Pick<PageProps, "api" | "project" | "refresh"> & { node: string }) {
  const [isStarting, setStarting] = useState(false);
  const link = useRobot();
  useEffect(() => {
    link.choose(node);
    return link.watch();
  }, [node]);
  const live = link.live.value;
  const { kind, why, trouble } = link.connection.value;
  return (
    <>
      <Header title={link.robot.value?.label ?? node} />
      <main class="robots robot">
        <div class="row">
          <a href={href({ page: "robots", name: "" })}>All robots</a>
          <NeedsServer changes>
            <Button
              label="Start a project from this robot"
              disabled={live === null}
              onClick={() => setStarting(true)}
            />
          </NeedsServer>
        </div>
        {isStarting && (
          <RobotStart
            {...{ ...props, node }}
            label={link.robot.value?.label ?? node}
            onClose={() => setStarting(false)}
          />
        )}
        {kind !== "connected" && <p>{why}</p>}
        <Problem text={trouble} />
        {live && <RobotTotals live={live} />}
        {live && <RobotTopics link={link} live={live} />}
        {link.robot.value?.node === node && <RobotChecks api={props.api} node={node} propose={null} />}
        {link.robot.value?.node === node && <RobotHistory api={props.api} node={node} />}
      </main>
    </>
  );
}

const NOW_S = 4;
const POINTER_HOLDS_MS = 5000;
const HASH_DIGITS = 8;
const COLUMNS = ["Robot", "State", "Heard", "Link", "Oldest at the operator", "Sent", "Rules"];

interface RobotTableProps {
  robots: readonly RobotSummary[];
  project: Project;
  robotsAgeS: number;
  /** Rows are to stay where they are, until `release`, or for so long. */
  hold: (forMs?: number) => void;
  release: () => void;
}

/** A row for each robot; on a narrow screen a card. Rows stay in place while somebody is about to choose one. */
function RobotTable({ robots, project, robotsAgeS, hold, release }: RobotTableProps) {
  return (
    <div class="table-scroll">
      <table
        class="robot-table"
        aria-label="Robots"
        onPointerMove={(event) => moved(event) && hold(POINTER_HOLDS_MS)}
        onPointerLeave={release}
        onFocusIn={() => hold()}
        onFocusOut={release}
      >
        <ColumnHeads names={COLUMNS} />
        <tbody>
          {robots.map((robot) => (
            <RobotRow key={robot.node} {...{ robot, project, robotsAgeS }} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** Whether the pointer itself moved, and not the page below it. */
function moved({ movementX, movementY }: PointerEvent): boolean {
  return movementX !== 0 || movementY !== 0;
}

type RowProps = Pick<RobotTableProps, "project" | "robotsAgeS"> & { robot: RobotSummary };

function RobotRow({ robot, project, robotsAgeS }: RowProps) {
  const trouble = troubleOf(robot, robotsAgeS);
  const silentS = robot.heard_s_ago + robotsAgeS;
  const { oldest } = robot;
  const { sha256 } = robot.rules;
  return (
    <tr class={lookOf(robot, trouble !== null)}>
      <th scope="row">
        <a href={wayTo(robot, project)}>{robot.label}</a>
      </th>
      <td data-label="State">
        <span class={trouble ? "trouble" : "well"}>{trouble?.words ?? "well"}</span>
      </td>
      <td data-label="Heard">{silentS < NOW_S ? "now" : `${duration(silentS)} ago`}</td>
      <td data-label="Link">{robot.link === null ? "none" : linkWords(robot.link)}</td>
      <td data-label="Oldest at the operator">
        {oldest === null ? "–" : <Oldest topic={oldest.topic} ageMs={oldest.age_ms} />}
      </td>
      <td data-label="Sent" class={isOverBudget(robot) ? "over" : ""}>
        <Sent robot={robot} />
      </td>
      <td data-label="Rules">
        {sha256 && <code title={sha256}>{sha256.slice(0, HASH_DIGITS)}</code>} {originOf(robot, robotsAgeS)}
      </td>
    </tr>
  );
}

function lookOf({ is_heard, health }: RobotSummary, isTroubled: boolean): string {
  if (!is_heard) return "silent";
  if (health?.level === "error") return "failing";
  return isTroubled ? "troubled" : "";
}

/** Beside the rules that it follows, if the project has any rules. */
function wayTo(robot: RobotSummary, project: Project): string {
  const rules = rulesFor(robot, project);
  return href(
    rules === null ? { page: "robots", name: robot.node } : { page: "rules", name: rules, robot: robot.node },
  );
}

function Oldest({ topic, ageMs }: { topic: string; ageMs: number }) {
  return (
    <>
      <span class={ageMs > OLD_MS ? "late" : ""}>{age(ageMs)}</span> <code>{topic}</code>
    </>
  );
}

function Sent({ robot: { budget_kb_per_s: budget, out_kb_per_s: sent, label } }: { robot: RobotSummary }) {
  if (budget === null) return <>{readable(sent)} KB/s, no budget</>;
  return (
    <>
      {readable(sent)} of {readable(budget)} KB/s
      <meter
        min={0}
        max={1}
        value={budget > 0 ? Math.min(sent / budget, 1) : 1}
        aria-label={`Sent by ${label}: share of the budget`}
      />
    </>
  );
}

const RELAYED_WITHOUT_RULES: Record<Fallback, string> = {
  full: "everything is relayed",
  readable: "what can be read of them is relayed, all else at 1 Hz",
  off: "nothing is relayed",
};

function originOf({ rules: { origin, files, waits_s, fallback } }: RobotSummary, robotsAgeS: number): string {
  switch (origin) {
    case "files":
      return files.map(baseName).join(", ") || "files";
    case "pushed":
      return "pushed";
    case "waiting":
      return waits_s === null
        ? "waiting to be confirmed"
        : `waiting to be confirmed, ${Math.max(0, Math.floor(waits_s - robotsAgeS))} s left`;
    case "fallback":
      return `none: ${RELAYED_WITHOUT_RULES[fallback ?? "full"]}`;
  }
}
