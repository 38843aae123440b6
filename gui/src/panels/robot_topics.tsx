// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import type { HealthLevel, HealthWords, Live, TopicStatus } from "../api/types";
import type { RobotLink } from "../state/robot_link";
import { fixed, readable } from "../ui/numbers";
import { Sparkline } from "./sparkline";

/** Every relayed topic of a robot as it is now. */
export function RobotTopics({ link, live: { status, health, bounds } }: { link: RobotLink; live: Live }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach
    <div class="table-scroll" tabIndex={0}>
      <table class={status.link ? "robot-topics linked" : "robot-topics"} aria-label="Topics of the robot">
        <thead>
          <tr>
            <th scope="col">Topic</th>
            <th scope="col">Source (Hz)</th>
            <th scope="col">Target (Hz)</th>
            <th scope="col">Actual (Hz)</th>
            <th scope="col">Actual, last 48 s</th>
            <th scope="col">Sent (KB/s)</th>
            {status.link &&
              LINK_COLUMNS.map((name) => (
                <th key={name} scope="col">
                  {name}
                </th>
              ))}
            <th scope="col">Decided by</th>
            <th scope="col">State</th>
          </tr>
        </thead>
        <tbody>
          {Object.entries(status.topics).map(([name, topic]) => (
            <TopicRow
              key={name}
              link={link}
              topic={name}
              cells={cellsOf(topic, health[name], bounds[name] ?? [])}
              linkCells={status.link ? linkCellsOf(topic) : null}
            />
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** What the row of a topic says, in the order of the columns, and how it looks; the sparkline is beside it. */
function cellsOf(topic: TopicStatus, health: HealthWords | undefined, bounds: readonly string[]): string {
  const rate = (hz: number | null) => (hz === null ? "–" : fixed(hz, 1));
  const target = topic.target_hz === null ? "Full" : readable(topic.target_hz);
  return [
    rate(topic.source_hz),
    target,
    rate(topic.actual_hz),
    fixed(topic.out_kb_per_s, 1),
    [topic.rule ?? REASONS[topic.reason] ?? topic.reason, ...bounds].join("; "),
    health?.message ?? "relayed",
    health ? LOOKS[health.level] : "",
  ].join("\n");
}

const LINK_COLUMNS = ["Age (ms)", "Replaced", "Queue (KB)"];

/** The same for the columns of a link. */
function linkCellsOf({ link }: TopicStatus): string {
  if (link === undefined) return "–\n–\n–";
  const age = link.age_ms === null ? "–" : String(Math.round(link.age_ms));
  return [age, readable(link.replaced), readable(link.queued_bytes / 1000)].join("\n");
}

const LOOKS: Record<HealthLevel, string> = { ok: "silent", stale: "silent", warn: "trouble", error: "failing" };

const REASONS: Record<string, string> = {
  default: "default",
  unknown: "unknown values",
  floor: "floor",
  budget: "budget",
  fallback: "no valid rules",
  reload: "new rules",
};

interface RowProps {
  link: RobotLink;
  topic: string;
  /** One text, so that a row in which nothing changed is left alone. */
  cells: string;
  linkCells: string | null;
}

function TopicRow({ link, topic, cells, linkCells }: RowProps) {
  return useMemo(() => {
    const [source, target, actual, sent, decider, state, look] = cells.split("\n");
    return (
      <tr class={look === "silent" ? look : ""}>
        <th scope="row">{topic}</th>
        <td class="number">{source}</td>
        <td class="number">{target}</td>
        <td class="number">{actual}</td>
        <td>
          <Sparkline link={link} topic={topic} />
        </td>
        <td class="number">{sent}</td>
        {linkCells?.split("\n").map((cell, column) => (
          <td key={LINK_COLUMNS[column]} class="number">
            {cell}
          </td>
        ))}
        <td class={decider === REASONS.fallback ? "failing" : ""}>{decider}</td>
        <td class={look}>{state}</td>
      </tr>
    );
  }, [topic, cells, linkCells]);
}
