// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Decision, TryAnswer, TryTopic } from "../api/types";
import { hz, readable } from "../ui/numbers";

const STRIP_HEIGHT_PX = 120;

/** Percent saved, the rates before and after, the path, and every decision. */
export function TryResult({ answer }: { answer: TryAnswer }) {
  return (
    <div class="try-result">
      <p class="headline" role="status">
        <strong>{answer.percent.toFixed(1)} % less</strong> sent: {readable(answer.after_kb)} of{" "}
        {readable(answer.before_kb)} KB in {readable(answer.duration_s)} s, with {answer.decisions.length} decisions.
      </p>
      {answer.notices.map((notice) => (
        <p key={notice} class="quiet">
          {notice}
        </p>
      ))}
      <p class="quiet">Messages per second: grey as recorded, green with the rules.</p>
      <div class="strips">
        {answer.topics.map((topic) => (
          <RateStrip key={topic.topic} topic={topic} binS={answer.bin_s} />
        ))}
      </div>
      {answer.path.length > 1 && <Path path={answer.path} decisions={answer.decisions} />}
      <Decisions answer={answer} />
    </div>
  );
}

function RateStrip({ topic, binS }: { topic: TryTopic; binS: number }) {
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!host.current) return;
    const plot = drawStrip(host.current, topic, binS);
    return () => plot.destroy();
  }, [topic]);
  return (
    <figure class="strip">
      <figcaption>
        <strong>{topic.topic}</strong>{" "}
        <span class="quiet">
          {topic.before_messages} → {topic.after_messages} messages
        </span>
      </figcaption>
      <div ref={host} />
    </figure>
  );
}

function drawStrip(host: HTMLElement, topic: TryTopic, binS: number): uPlot {
  const style = getComputedStyle(host);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const axis = { stroke: colour("--text-2"), grid: { stroke: colour("--line") }, font: `11px ${colour("--font")}` };
  const seconds = topic.before_hz_bins.map((_, bin) => bin * binS);
  return new uPlot(
    {
      width: host.clientWidth,
      height: STRIP_HEIGHT_PX,
      cursor: { sync: { key: "try" } },
      scales: { x: { time: false } },
      legend: { show: false },
      axes: [axis, { ...axis, size: 44 }],
      series: [
        {},
        { stroke: colour("--text-2"), width: 1 },
        { stroke: colour("--accent"), width: 2, fill: colour("--accent-soft") },
      ],
    },
    [seconds, topic.before_hz_bins, topic.after_hz_bins],
    host,
  );
}

/** The path in metres, with a dot wherever a decision fell. */
function Path({ path, decisions }: { path: TryAnswer["path"]; decisions: readonly Decision[] }) {
  const [xs, ys] = [path.map(([, x]) => x), path.map(([, , y]) => y)];
  const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const margin = Math.max(right - left, high - low, 1) * 0.06;
  const box = [left - margin, -high - margin, right - left + 2 * margin, high - low + 2 * margin];
  const points = path.map(([, x, y]) => `${x},${-y}`).join(" ");
  const dots = decisions.filter((decision) => decision.start !== true).map((decision) => nearest(path, decision.t));
  return (
    <figure class="path">
      <figcaption>
        <strong>Path</strong>{" "}
        <span class="quiet">
          {readable(right - left)} m × {readable(high - low)} m; dots are decisions
        </span>
      </figcaption>
      <svg viewBox={box.join(" ")} role="img" aria-label="Path of the robot">
        <polyline points={points} />
        {dots.map(([t, x, y]) => (
          <circle key={`${t} ${x}`} cx={x} cy={-y} r={margin / 5} />
        ))}
      </svg>
    </figure>
  );
}

function nearest(path: TryAnswer["path"], t: number): TryAnswer["path"][number] {
  return path.find(([at]) => at >= t) ?? path.at(-1) ?? [0, 0, 0];
}

function Decisions({ answer }: { answer: TryAnswer }) {
  return (
    <table class="decisions">
      <caption>Decisions{answer.has_more_decisions && " (the first ones)"}</caption>
      <thead>
        <tr>
          <th>Time (s)</th>
          <th>Topic</th>
          <th>From</th>
          <th>To</th>
          <th>Because of</th>
        </tr>
      </thead>
      <tbody>
        {answer.decisions.map((decision, index) => (
          <tr key={index}>
            <td class="number">{decision.t.toFixed(1)}</td>
            <td>{decision.topic}</td>
            <td class="number">{decision.from_hz === undefined ? "–" : hz(decision.from_hz)}</td>
            <td class="number">{hz(decision.to_hz)}</td>
            <td>{decision.rule ?? decision.reason}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
