// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useComputed, useSignal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Project } from "../api/types";
import { RobotStart } from "../panels/project_start";
import { RobotHistory } from "../panels/robot_history";
import { RobotTable } from "../panels/robot_table";
import { RobotTopics } from "../panels/robot_topics";
import { RobotTotals } from "../panels/robot_totals";
import { href } from "../route";
import { byTrouble, inOrderOf, troubleOf } from "../state/robot_trouble";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { Header } from "../ui/header";
import { later } from "../ui/later";
import { Problem } from "../ui/notice";
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
              <RobotTable robots={shown} project={project} sinceToldS={link.sinceToldS.value} {...{ hold, release }} />
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
