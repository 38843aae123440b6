// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { RuleZones, TryIncident, TryTopic } from "../api/types";
import type { KeptIncidents } from "../incidents/kept_incidents";
import { missingWords, sumOf, windowWords } from "../incidents/missing_words";
import type { MapZone } from "../map/shapes";
import { href } from "../route";
import { MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import { sentKbPerS, type Trial } from "../state/trial";
import { ZoneEditor } from "../state/zone_editor";
import { Button, Icon, type IconName } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { ColumnHeads } from "../ui/data_table";
import { Problem } from "../ui/notice";
import { counted, durationWords, hz, percent, readable, sizeWords } from "../ui/numbers";
import { showOnNarrow } from "../ui/watch";
import { Bar, Lane, ruleColour, TimeAxis } from "./axis";
import { Chart } from "./chart";
import { RuleLanes } from "./check_chart";
import { CheckCourses } from "./check_courses";
import { errorWords, lossWords, missedWords, StaleNotice } from "./folder_result";
import { LossTables } from "./loss_tables";
import { PathMap } from "./path_map";

interface Props {
  editor: RuleEditor;
  trial: Trial;
  keptIncidents: KeptIncidents;
  /** What is another one since the try: `rules`, `profile`, `recording`. */
  changed: readonly string[];
}

/** A try: what it saved, and below one scrubber the map, the rules, the rates, the loss and every decision. */
export function TryResult({ editor, trial, keptIncidents, changed }: Props) {
  const { answer } = trial;
  const [worst, error, missed] = [lossWords(answer), errorWords(answer), missedWords(answer)];
  const kbPerS = sentKbPerS(answer);
  const isOld = editor.text.value !== trial.tried.text;
  const result = useRef<HTMLDivElement>(null);
  useEffect(() => followInEditor(editor, trial), [trial]);
  useEffect(() => showOnNarrow(() => result.current), [trial]);
  return (
    <div class="try-result" ref={result}>
      <p class="headline" role="status">
        <strong>{percent(answer.percent)} % less sent</strong>
        {worst && `; ${worst}`}
      </p>
      <p class="quiet">
        {sizeWords(answer.after_kb)} of {sizeWords(answer.before_kb)} in {durationWords(answer.duration_s)}
        {kbPerS !== null && `, ${readable(kbPerS)} KB/s`}. The rules decided {counted(answer.decision_count, "time")}
        {answer.path.length > 1 && ", where the map has dots"}. {error && `Largest error (RMSE): ${error}. `}
        {missed && `Thresholds missed: ${missed}.`}
      </p>
      <StaleNotice changed={changed} advice="Run the rules again to see what they do now." />
      {answer.notices.length > 0 && (
        <div class="quiet">
          {answer.notices.map((notice) => (
            <p key={notice}>{notice}</p>
          ))}
        </div>
      )}
      <TrialAxis trial={trial} map={answer.path.length > 1 && <TryMap {...{ editor, trial }} />}>
        <RuleLanes
          title={`Rules at ${trial.time.value.toFixed(1)} s, and when they held`}
          rules={trial.rules.value}
          timeline={trial}
          show={isOld ? null : (line) => editor.showLine(line)}
        />
        <CheckCourses {...{ editor, trial }} />
        <RateCharts trial={trial} />
        <LossTables trial={trial} />
      </TrialAxis>
      <TriedIncidents keptIncidents={keptIncidents} trial={trial} />
      <DecisionTable trial={trial} />
    </div>
  );
}

/** Marks in text and blocks which rule decides, from when somebody moves the time. */
function followInEditor(editor: RuleEditor, trial: Trial): () => void {
  const opened = trial.time.peek();
  let shown: number | null | undefined;
  return effect(() => {
    const line = trial.leader.value?.line ?? null;
    if (trial.time.value === opened && shown === undefined) return;
    if (line === shown || editor.text.peek() !== trial.tried.text) return;
    shown = line;
    editor.showLine(line);
  });
}

/** Where the robot went and is at the time of the scrubber, with a dot wherever something was decided. */
function TryMap({ editor, trial }: { editor: RuleEditor; trial: Trial }) {
  const zones = useMemo(() => new ZoneEditor(editor), []);
  const floor = useMemo(() => new MapFloor(editor), []);
  useEffect(() => zones.follow(), []);
  useEffect(() => floor.followPicture(), []);
  const deciding = trial.rules.value.filter(({ decides }) => decides.length > 0).map(({ rule }) => rule);
  const shown = useMemo(() => zonesAt(zones.rules.value, deciding), [zones.rules.value, deciding.join("\n")]);
  return (
    <PathMap
      timeline={trial}
      path={trial.answer.path}
      dotsS={trial.decisionTimes}
      dotsAre="Dots are decisions."
      picture={floor.picture.value}
      zones={shown}
    />
  );
}

/** The zones of the rules; those of the rules in `deciding` are in another colour. */
export function zonesAt(rules: readonly RuleZones[], deciding: readonly string[]): MapZone[] {
  return rules
    .filter((rule) => rule.zones.length > 0)
    .map(({ id, label, zones }) => ({
      id,
      label,
      rectangles: zones.map((zone) => zone.rectangle),
      tone: deciding.includes(label) ? "selected" : "zone",
    }));
}

/** The time of a try, with a tick for each decision. */
function TrialAxis({ trial, map, children }: { trial: Trial; map: ComponentChildren; children: ComponentChildren }) {
  const time = trial.time.value;
  const leader = trial.leader.value;
  const decides = leader ? `${leader.rule} decides` : "defaults decide";
  return (
    <TimeAxis
      timeline={trial}
      label="Time in the recording (s)"
      words={`${time.toFixed(1)} s of ${durationWords(trial.durationS)}, ${decides}`}
      said={`${time.toFixed(1)} s`}
      ticksS={trial.decisionTimes}
      buttons={
        <>
          <DecisionStep trial={trial} step={-1} label="Decision before" icon="before" />
          <DecisionStep trial={trial} step={1} label="Next decision" icon="after" />
        </>
      }
      beside={map}
    >
      {children}
    </TimeAxis>
  );
}

function DecisionStep({ trial, step, label, icon }: { trial: Trial; step: -1 | 1; label: string; icon: IconName }) {
  const next = trial.neighbour(step);
  return (
    <button
      type="button"
      class="small"
      aria-label={label}
      title={label}
      disabled={next === null}
      onClick={() => next !== null && trial.goTo(next)}
    >
      <Icon name={icon} />
    </button>
  );
}

const IN_DOUBT: Record<string, string> = { unknown: ", which might hold" };

/** The rate of every topic over time, before and after, with the rules that decided it. */
function RateCharts({ trial }: { trial: Trial }) {
  return (
    <section aria-label="Rates">
      <h3>Rates (Hz) over time (s)</h3>
      <p class="quiet">
        Dashed as recorded, filled with the rules; below, the rule that decides. Press or drag to move the time.
      </p>
      {trial.answer.topics.map((topic) => (
        <RateChart key={topic.topic} {...{ trial, topic }} />
      ))}
    </section>
  );
}

function RateChart({ trial, topic }: { trial: Trial; topic: TryTopic }) {
  const lines = useMemo(
    () => ({ before: trial.whole(topic.before_hz_bins), after: trial.whole(topic.after_hz_bins) }),
    [trial, topic],
  );
  const parts = useMemo(() => decidedBy(trial, topic.topic), [trial, topic]);
  return (
    <>
      <Chart timeline={trial} lines={lines} label={`Rate of ${topic.topic}`}>
        <strong>{topic.topic}</strong> <RateNow {...{ trial, topic }} />
      </Chart>
      {parts.length > 0 && (
        <Lane timeline={trial}>
          <Bar {...{ timeline: trial, parts }} label={`What decides ${topic.topic}`} title={rulesIn(parts)} />
        </Lane>
      )}
    </>
  );
}

/** When a rule decided the rate of a topic, in the colour of its lane; nothing where a default did. */
function decidedBy(trial: Trial, topic: string) {
  const { blocks, decisions } = trial.answer;
  const own = decisions.filter((one) => one.topic === topic);
  return own.flatMap(({ t, line, rule }, at) => {
    const block = blocks.findIndex((one) => one.line === line && one.rule === rule);
    const [fromS, toS] = [t, own[at + 1]?.t ?? trial.durationS];
    return rule === null || block < 0 ? [] : [{ fromS, toS, colour: ruleColour(block), rule }];
  });
}

function rulesIn(parts: readonly { rule: string }[]): string {
  return [...new Set(parts.map(({ rule }) => rule))].join(", ");
}

function RateNow({ trial, topic }: { trial: Trial; topic: TryTopic }) {
  const bin = trial.bin.value;
  const decision = trial.plan.value.get(topic.topic);
  const [before, after] = [topic.before_hz_bins[bin] ?? 0, topic.after_hz_bins[bin] ?? 0];
  return (
    <span class="quiet">
      {decision && `${hz(decision.to_hz)} by ${decision.rule ?? decision.reason}${IN_DOUBT[decision.reason] ?? ""}: `}
      {readable(after)} of {readable(before)} Hz sent
    </span>
  );
}

/** Every decision; a time leads there. */
function DecisionTable({ trial }: { trial: Trial }) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => (box.current ? followTime(box.current, trial) : undefined), [trial]);
  const { decisions, decision_count } = trial.answer;
  return (
    <section aria-label="Decisions">
      <h3>Decisions{decision_count > decisions.length && ` (the first ${decisions.length} of ${decision_count})`}</h3>
      <div class="decision-box" ref={box}>
        <table class="try-table">
          <ColumnHeads names={["Time (s)", "Topic", "From", "To", "Because of"]} />
          <tbody>
            {decisions.map((decision, index) => (
              <tr key={index}>
                <td class="number">
                  <Button label={decision.t.toFixed(1)} class="link" onClick={() => trial.goTo(decision.t)} />
                </td>
                <td>{decision.topic}</td>
                <td class="number">{decision.start ? "–" : hz(decision.from_hz ?? null)}</td>
                <td class="number">{hz(decision.to_hz)}</td>
                <td>{[decision.rule ?? decision.reason, ...decision.bounds].join("; ")}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

/** Marks the decisions that rates come from now, and keeps the latest of them in sight. */
function followTime(box: HTMLElement, trial: Trial): () => void {
  const { decisions } = trial.answer;
  const rows = [...box.querySelectorAll<HTMLElement>("tbody tr")];
  let marked: HTMLElement[] = [];
  return effect(() => {
    const valid = new Set(trial.plan.value.values());
    for (const row of marked) row.removeAttribute("aria-current");
    marked = rows.filter((_, index) => valid.has(decisions[index] as (typeof decisions)[number]));
    for (const row of marked) row.setAttribute("aria-current", "time");
    const last = marked.at(-1);
    if (last) box.scrollTop = last.offsetTop - box.clientHeight / 2;
  });
}

/** What the rules would have recorded of the bag; a time leads there, and each can be kept in the project. */
function TriedIncidents({ keptIncidents, trial }: { keptIncidents: KeptIncidents; trial: Trial }) {
  const { incidents } = trial.answer;
  if (incidents === null) return null;
  return (
    <section class="tried-incidents" aria-label="What the rules would have recorded">
      <h3>
        What the rules would have recorded{" "}
        {incidents.length > 0 && <span class="quiet">(red on the slider and the charts)</span>}
      </h3>
      <Problem text={keptIncidents.problem.value} />
      {incidents.length === 0 ? (
        <p class="quiet">
          Nothing: no rule with a recording began to hold. One that holds from the start on begins nothing either,
          before it was known not to hold.
        </p>
      ) : (
        <ul>
          {incidents.map((incident) => (
            <TriedIncident key={incident.number} {...{ keptIncidents, trial, incident }} />
          ))}
        </ul>
      )}
    </section>
  );
}

function TriedIncident(props: { keptIncidents: KeptIncidents; trial: Trial; incident: TryIncident }) {
  const { keptIncidents, trial, incident } = props;
  const { t, record } = incident;
  const { rule, topics, missing, moments = 1 } = record;
  const keep = keptIncidents.of(trial, incident.number);
  const name = `${record.name} at ${t.toFixed(1)} s`;
  return (
    <li>
      <div class="row">
        <Button label={`${t.toFixed(1)} s`} class="link" title="Move the time there" onClick={() => trial.goTo(t)} />
        <strong>{record.name}</strong>
        <span>
          by {rule}, {windowWords(record)}: {counted(sumOf(topics, "messages"), "message")},{" "}
          {sizeWords(sumOf(topics, "bytes") / 1000)}
          {moments > 1 && `, ${counted(moments - 1, "further moment")}`}
        </span>
        {(keep === null || keep.state === "failed") && (
          <NeedsServer changes>
            <Button
              label="Keep it"
              class="small"
              onClick={() => void keptIncidents.keep(trial, incident.number, name)}
              aria-label={`Keep it: ${name}`}
            />
          </NeedsServer>
        )}
        {keep?.state === "running" && <span class="quiet">Being kept: {Math.round(100 * keep.share)} %</span>}
        {keep?.kept != null && (
          <span>
            Kept: <a href={href({ page: "incidents", name: keep.kept })}>{keep.kept}</a>
          </span>
        )}
        {keep?.state === "failed" && <span class="problem">{keep.problem}</span>}
      </div>
      <p class="quiet">
        {Object.entries(topics)
          .map(([topic, { messages, bytes }]) => `${topic} ${counted(messages, "message")}, ${sizeWords(bytes / 1000)}`)
          .join("; ")}
      </p>
      {missing.length > 0 && <p class="missing">Missing: {missingWords(missing, record.triggered_ns).join("; ")}.</p>}
    </li>
  );
}
