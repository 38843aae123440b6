// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useComputed, useSignal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { refusalOf } from "../api/client";
import type { Fallback, Project, RobotSummary } from "../api/types";
import { RobotStart } from "../panels/project_start";
import { RobotDetails, RobotTopics, RobotTotals } from "../panels/robot_view";
import { href } from "../route";
import { duration, inOrderOf, linkWords, rulesFor } from "../state/robot_trouble";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { ColumnHeads } from "../ui/data_table";
import { baseName } from "../ui/files";
import { Header } from "../ui/header";
import { later } from "../ui/later";
import { Problem } from "../ui/notice";
import { moment, readable } from "../ui/numbers";
import type { PageProps } from "./page_props";

const RobotPast = later(async () => (await import("../panels/robot_past")).RobotPast);

/** All robots that are heard, or, with a name, that robot without any rules beside it. */
export function RobotsPage({ api, project, refresh, name }: PageProps) {
  return name === "" ? <AllRobots {...{ api, project }} /> : <OneRobot {...{ api, project, refresh }} node={name} />;
}

/** So few robots are seen at a glance. */
const FEW = 10;

function AllRobots({ api, project }: Pick<PageProps, "api" | "project">) {
  const link = useRobot();
  const onlyTrouble = useSignal(false);
  const [refused, setRefused] = useState("");
  /** The order in which rows stay while somebody is about to choose one. */
  const held = useSignal<string[] | null>(null);
  const robots = useComputed(() => inOrderOf(held.value ?? [], link.robots.value?.robots ?? []));
  const troubled = useComputed(() => robots.value.filter(({ health }) => health !== null));
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
  const remove = async (node: string) => setRefused(await refusalOf(() => api.ask("POST /api/robot/remove", { node })));
  const shown = onlyTrouble.value ? troubled.value : robots.value;
  return (
    <>
      <Header title="Robots" />
      <main class="robots">
        <Problem text={refused} />
        {robots.value.length === 0 ? (
          <p class="quiet">{link.connection.value.why}</p>
        ) : (
          <>
            <div class="row">
              <p role="status">{counted(robots.value.length, troubled.value.length)}</p>
              {robots.value.length >= FEW && (
                <label>
                  <input
                    type="checkbox"
                    checked={onlyTrouble.value}
                    onChange={(event) => (onlyTrouble.value = event.currentTarget.checked)}
                  />
                  Only those with trouble
                </label>
              )}
            </div>
            {shown.length === 0 && <p class="quiet">No robot is in trouble.</p>}
            {shown.length > 0 && (
              <RobotTable
                robots={shown}
                robotsAgeS={link.robotsAgeS.value}
                {...{ project, hold, release }}
                remove={(node) => void remove(node)}
              />
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
          <RulesLink robot={link.robot.value} project={props.project} />
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
        {live && <RobotDetails link={link} live={live} />}
        {link.robot.value?.node === node && <RobotPast api={props.api} node={node} propose={null} />}
      </main>
    </>
  );
}

/** The way to the rules that a robot follows, beside it. */
function RulesLink({ robot, project }: { robot: RobotSummary | null; project: Project }) {
  const rules = robot && rulesFor(robot, project);
  return robot && rules ? <a href={href({ page: "rules", name: rules, robot: robot.node })}>Open {rules}</a> : null;
}

const NOW_S = 4;
const POINTER_HOLDS_MS = 5000;
const COLUMNS = ["Robot", "State", "Last heard", "Link", "Sent", "Rules"];

interface RobotTableProps {
  robots: readonly RobotSummary[];
  project: Project;
  robotsAgeS: number;
  /** Rows are to stay where they are, until `release`, or for so long. */
  hold: (forMs?: number) => void;
  release: () => void;
  remove: (node: string) => void;
}

/** A row for each robot; on a narrow screen a card. Rows stay in place while somebody is about to choose one. */
function RobotTable({ robots, hold, release, ...props }: RobotTableProps) {
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
            <RobotRow key={robot.node} {...props} robot={robot} />
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

type RowProps = Pick<RobotTableProps, "project" | "robotsAgeS" | "remove"> & { robot: RobotSummary };

function RobotRow({ robot, project, robotsAgeS, remove }: RowProps) {
  const { node, label, health, is_heard, topics } = robot;
  const silentS = robot.heard_s_ago + robotsAgeS;
  const rules = rulesFor(robot, project);
  return (
    <tr class={health?.level ?? ""}>
      <th scope="row">
        <a href={href({ page: "robots", name: node })}>{label}</a>
      </th>
      <td data-label="State">
        <span class="state">{health?.message ?? `relays ${topics === 1 ? "1 topic" : `${topics} topics`}`}</span>
      </td>
      <td data-label="Last heard">
        <span>{silentS < NOW_S ? "now" : `${duration(silentS)} ago`}</span>
        {!is_heard && (
          <>
            <small>{moment(Date.now() - 1000 * silentS)}</small>
            <NeedsServer changes>
              <Button label="Remove" class="small" aria-label={`Remove ${label}`} onClick={() => remove(node)} />
            </NeedsServer>
          </>
        )}
      </td>
      <td data-label="Link">{!is_heard ? "–" : robot.link === null ? "none" : linkWords(robot.link)}</td>
      <td data-label="Sent">{is_heard ? <Sent robot={robot} /> : "–"}</td>
      <td data-label="Rules">
        {rules ? (
          <a href={href({ page: "rules", name: rules, robot: node })}>{originOf(robot, robotsAgeS)}</a>
        ) : (
          originOf(robot, robotsAgeS)
        )}
      </td>
    </tr>
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
