// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { HealthLevel, HealthWords, Live, TopicStatus } from "../api/types";
import { type RateRing, RING_LENGTH, type RobotLink, UPDATE_RATES_HZ } from "../state/robot_link";
import { hourly, linkWords } from "../state/robot_trouble";
import { Choice } from "../ui/choice";
import { ColumnHeads } from "../ui/data_table";
import { clock, fixed, NS_PER_MS, readable } from "../ui/numbers";

/** Every relayed topic of a robot as it is now. */
export function RobotTopics({ link, live: { status, health, bounds } }: { link: RobotLink; live: Live }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach
    <div class="table-scroll" tabIndex={0}>
      <table class={status.link ? "robot-topics linked" : "robot-topics"} aria-label="Topics of the robot">
        <ColumnHeads names={[...RATE_COLUMNS, ...(status.link ? LINK_COLUMNS : []), "Decided by", "State"]} />
        <tbody>
          {Object.entries(status.topics).map(([name, topic]) => (
            <TopicRow
              key={name}
              link={link}
              topic={name}
              cells={cellsOf(topic, health[name], bounds[name] ?? [])}
              linkCells={status.link ? linkCellsOf(topic, status.uptime_s) : null}
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

const RATE_COLUMNS = ["Topic", "Source (Hz)", "Target (Hz)", "Actual (Hz)", "Actual, last 48 s", "Sent (KB/s)"];
const LINK_COLUMNS = ["Age (ms)", "Replaced, lost, repaired", "Queue (KB)", "MB/h"];

/** What the row of a topic says in the columns of a link, on which it was for so long. */
function linkCellsOf({ link }: TopicStatus, uptimeS: number): string {
  if (link === undefined) return LINK_COLUMNS.map(() => "–").join("\n");
  const age = link.age_ms === null ? "–" : String(Math.round(link.age_ms));
  const counts = [link.replaced, link.lost_replaced + link.lost_late, link.repaired].map(readable);
  return [age, counts.join(", "), readable(link.queued_bytes / 1000), hourly(link.sent_bytes, uptimeS)].join("\n");
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
  /** A single text: an equal one does not draw the row again. */
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

/** What all topics take of the link together, and what rules say, accept and record. */
export function RobotTotals({ live: { status, accepted, recording } }: { live: Live }) {
  const sent = status.out_kb_per_s;
  const budget = status.budget_kb_per_s;
  const [shown, leftOut] = [status.blocks.length, status.blocks_left_out ?? 0];
  return (
    <dl class="robot-totals">
      <div class={budget !== null && sent > budget ? "over wide" : "wide"}>
        <dt>Sent</dt>
        <dd>
          <strong>{readable(sent)}</strong>{" "}
          {budget === null
            ? "KB/s, no budget set"
            : `of ${readable(budget)} KB/s (${readable((100 * sent) / budget)} %)`}
        </dd>
        {budget !== null && (
          <meter min={0} max={1} value={Math.min(sent / budget, 1)} aria-label="Sent: share of the budget" />
        )}
      </div>
      {(status.notices ?? []).map(({ text, rule, since_ns }) => (
        <Figure
          key={`${rule} ${text}`}
          name={rule ?? "A rule says"}
          value={`“${text}” since ${clock(since_ns / NS_PER_MS)}`}
          isTroubled
        />
      ))}
      {status.link && <Figure name="Link" value={linkWords(status.link)} />}
      {status.link && (
        <Figure
          name="Over the link"
          value={`${hourly(status.link.sent_bytes + status.link.report_bytes, status.uptime_s)} MB/h`}
        />
      )}
      {Object.entries(status.accepted ?? {}).map(([topic, { problem }], place) => (
        <Figure key={topic} name={`Accepts ${topic}`} value={accepted[place] ?? ""} isTroubled={problem !== null} />
      ))}
      {recording !== null && (
        <Figure name="Records" value={recording} isTroubled={typeof status.incidents?.problem === "string"} />
      )}
      {leftOut > 0 && <Figure name="Rules shown" value={`${shown} of ${shown + leftOut}`} />}
    </dl>
  );
}

/** What the runtime takes of its machine, what watching it takes of the link, and which text its rules have. */
export function RobotDetails({ link, live: { status, status_kb_per_s } }: { link: RobotLink; live: Live }) {
  return (
    <details>
      <summary>Details</summary>
      <dl class="robot-totals">
        <Figure name="Received from its sources" value={`${readable(status.in_kb_per_s)} KB/s`} />
        <Figure name="Its statuses" value={`up to ${readable(status_kb_per_s)} KB/s`} />
        <Figure name="CPU" value={status.cpu_percent === null ? "–" : `${fixed(status.cpu_percent, 1)} %`} />
        <Figure name="Memory" value={status.memory_mb === null ? "–" : `${fixed(status.memory_mb, 0)} MB`} />
        <Figure name="SHA-256 of its rules" value={status.rules.sha256 || "–"} />
      </dl>
      <Choice
        label="Updates (1/s)"
        value={link.updateHz.value}
        choices={UPDATE_RATES_HZ}
        choose={(rate) => link.updateAt(rate)}
      />
    </details>
  );
}

function Figure({ name, value, isTroubled }: { name: string; value: string; isTroubled?: boolean }) {
  return (
    <div class={isTroubled ? "trouble" : ""}>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}

const WIDTH_PX = 120;
const HEIGHT_PX = 24;

/** The actual rate of a topic over the last seconds, drawn with the next picture that the screen shows. */
function Sparkline({ link, topic }: { link: RobotLink; topic: string }) {
  const host = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const context = host.current?.getContext("2d");
    if (!context) return;
    const scale = devicePixelRatio;
    context.canvas.width = WIDTH_PX * scale;
    context.canvas.height = HEIGHT_PX * scale;
    context.setTransform(scale, 0, 0, scale, 0, 0);
    let frame = 0;
    const stop = effect(() => {
      void link.samples.value;
      cancelAnimationFrame(frame);
      frame = requestAnimationFrame(() => draw(context, link.rates.of(topic)));
    });
    return () => {
      stop();
      cancelAnimationFrame(frame);
    };
  }, [topic]);
  // biome-ignore lint/a11y/noAriaHiddenOnFocusable: the keyboard does not reach a canvas without tabIndex
  return <canvas ref={host} class="sparkline" aria-hidden="true" />;
}

function draw(context: CanvasRenderingContext2D, ring: RateRing): void {
  const highest = ring.highest();
  context.clearRect(0, 0, WIDTH_PX, HEIGHT_PX);
  // The style sheet's colour of the canvas, which follows the light or dark setting.
  context.strokeStyle = getComputedStyle(context.canvas).color;
  context.lineWidth = 1.5;
  context.beginPath();
  let isDown = false;
  for (let age = 0; age < RING_LENGTH; age++) {
    const rate = ring.at(age);
    const [x, y] = [(age / (RING_LENGTH - 1)) * WIDTH_PX, HEIGHT_PX - 2 - (rate / highest) * (HEIGHT_PX - 4)];
    if (Number.isNaN(rate)) isDown = false;
    else if (isDown) context.lineTo(x, y);
    else {
      context.moveTo(x, y);
      isDown = true;
    }
  }
  context.stroke();
}
