// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, signal } from "@preact/signals";
import { useEffect, useMemo } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import type { IncidentAnswer, IncidentCourse, IncidentRecord, TopicRates } from "../api/types";
import type { MapPicture, MapZone } from "../map/shapes";
import { href } from "../route";
import { layoutName, PLAIN_GRID, readLayout } from "../state/layout";
import { MapFloor } from "../state/map_floor";
import { Timeline } from "../state/timeline";
import { PathMap } from "../try/path_map";
import { Scrubber, Strip } from "../try/strip";
import { zonesAt } from "../try/try_result";
import { Button } from "../ui/button";
import { DataTable } from "../ui/data_table";
import { Notes } from "../ui/notice";
import { counted, moment, NS_PER_MS, readable, sizeWords } from "../ui/numbers";
import { furtherWords, missingWords, sinceMoment, sinceTrigger, sumOf, valueWords, windowWords } from "./missing_words";

/** Why an incident was recorded, and what is missing of it. */
export function IncidentFacts({ incident }: { incident: IncidentAnswer }) {
  const { record, units } = incident;
  const messages = sumOf(record.topics, "messages");
  const values = valueWords(record.values, units);
  const further = furtherWords(record, units);
  return (
    <>
      <p class="headline">
        The rule <strong>{record.rule}</strong> began to hold at {moment(record.triggered_ns / NS_PER_MS)}.
      </p>
      <dl class="facts">
        <dt>Because</dt>
        <dd>{values.length === 0 ? "its condition reads no values" : values.join(", ")}</dd>
        {further.length > 0 && (
          <>
            <dt>Again</dt>
            <dd>
              <ul class="moments" aria-label="Further moments">
                {further.map((words, place) => (
                  <li key={`${place} ${words}`}>{words}</li>
                ))}
              </ul>
            </dd>
          </>
        )}
        <dt>Rule</dt>
        <dd>
          <RuleLink incident={incident} />
        </dd>
        <dt>Kept</dt>
        <dd>
          {counted(messages, "message")} of {counted(Object.keys(record.topics).length, "topic")},{" "}
          {sizeWords(incident.size_bytes / 1000)}, from {windowWords(record)}
        </dd>
        <dt>Missing</dt>
        <dd>
          {record.missing.length === 0 ? (
            "nothing"
          ) : (
            <ul class="missing" aria-label="Missing">
              {missingWords(record.missing, record.triggered_ns).map((words) => (
                <li key={words}>{words}</li>
              ))}
            </ul>
          )}
        </dd>
        <dt>Folder</dt>
        <dd class="path">{incident.name}</dd>
      </dl>
    </>
  );
}

/** Where the rule stands: in a file of the project, if it has that. */
function RuleLink({ incident: { rule_file, is_same_text, record } }: { incident: IncidentAnswer }) {
  const { rule, file, line } = record;
  if (rule_file === null) {
    return (
      <>
        line {line} of <code>{file}</code>, which is not in this project
      </>
    );
  }
  return (
    <>
      <a href={href({ page: "rules", name: rule_file, ...(is_same_text ? { line: String(line) } : {}) })}>
        {rule} in {rule_file}
      </a>
      , line {line}
      {!is_same_text && <span class="quiet"> (the file is another one now than when this was recorded)</span>}
    </>
  );
}

/** What an incident holds of each topic. */
export function RecordedTopics({ record }: { record: IncidentRecord }) {
  return (
    <section aria-label="Topics">
      <h2>Topics</h2>
      <DataTable
        label="Topics"
        heads={["Topic", "Messages", "Size"]}
        rows={Object.entries(record.topics).map(([topic, { type, messages, bytes }]) => [
          <>
            {topic}
            <div class="quiet">{type || "not published"}</div>
          </>,
          <>
            {readable(messages)}
            <Latched record={record} topic={topic} />
          </>,
          sizeWords(bytes / 1000),
        ])}
      />
    </section>
  );
}

/** How much came before the window and still counted in it. */
function Latched({ record, topic }: { record: IncidentRecord; topic: string }) {
  const latched = record.latched.filter((one) => one.topic === topic);
  const [first] = latched;
  if (!first) return null;
  const came =
    latched.length === 1 ? `came ${sinceTrigger(first.stamp_ns, record.triggered_ns)}` : "from before the window";
  return (
    <div class="quiet">
      {readable(latched.length)} still valid, {came}
    </div>
  );
}

/** What happened around the moment of an incident: one slider for the path and the rates of all topics. */
export function CourseView({ course, ground }: { course: IncidentCourse; ground: Ground }) {
  const { trigger_s, topics } = course;
  // Charts count from its moment, where the slider is at first.
  const timeline = useMemo(
    () => new Timeline(course, topics[0]?.hz_bins.length ?? 0, trigger_s, [trigger_s]),
    [course],
  );
  const now = sinceMoment(timeline.time.value - trigger_s);
  const dotsS = useMemo(() => [trigger_s], [course]);
  return (
    <section class="incident-course" aria-label="Around the moment">
      <h2>Around the moment</h2>
      <Notes notes={course.notices} />
      <Scrubber
        timeline={timeline}
        label="Time around the moment (s)"
        words={now}
        said={now}
        ticksS={NONE}
        after={
          <Button
            label="To the moment"
            class="small"
            disabled={now === "the moment"}
            onClick={() => timeline.goTo(trigger_s)}
          />
        }
      />
      <div class={course.path.length > 1 ? "try-columns" : ""}>
        {course.path.length > 1 && (
          <PathMap
            timeline={timeline}
            path={course.path}
            dotsS={dotsS}
            dotsAre="The dot is the moment."
            picture={ground.picture.value}
            zones={ground.zones.value}
            isNear
          />
        )}
        <section class="try-column" aria-label="Rates">
          <h3>Messages a second (Hz); 0 s is the moment</h3>
          {topics.map((topic) => (
            <TopicStrip key={topic.topic} {...{ timeline, topic }} />
          ))}
        </section>
      </div>
    </section>
  );
}

const NONE: readonly number[] = [];

function TopicStrip({ timeline, topic }: { timeline: Timeline; topic: TopicRates }) {
  const lines = useMemo(() => ({ after: topic.hz_bins }), [topic]);
  const now = topic.hz_bins[timeline.bin.value] ?? null;
  return (
    <Strip timeline={timeline} lines={lines} label={`Rate of ${topic.topic}`}>
      <strong>{topic.topic}</strong> <span class="quiet">{now === null ? "" : `${readable(now)} Hz`}</span>
    </Strip>
  );
}

/** What a path is drawn on. */
interface Ground {
  picture: Signal<MapPicture | null>;
  zones: Signal<readonly MapZone[]>;
}

/** The map of the rule file that recorded an incident, and its zones if it holds the same text as then. */
export function useRuleGround(api: Api, incident: IncidentAnswer): Ground {
  const { rule_file, is_same_text, record } = incident;
  const zones = useMemo(() => signal<readonly MapZone[]>([]), []);
  // Without it there is a plain grid, and the rest of the page is as it was.
  const owner = useMemo(() => ({ api, map: signal(PLAIN_GRID), attempt: refusalOf }), []);
  const floor = useMemo(() => new MapFloor(owner), []);
  useEffect(() => floor.followPicture(), []);
  useEffect(() => {
    if (rule_file === null) return;
    const load = async () => {
      const { files } = await api.project();
      if (files.some(({ name }) => name === layoutName(rule_file))) {
        owner.map.value = (await readLayout(api, rule_file)).map;
      }
      if (!is_same_text) return;
      const { text } = await api.read(rule_file);
      const { rules } = await api.ask("POST /api/zones", { text, name: rule_file, profile_text: null });
      zones.value = zonesAt(rules, [record.rule]);
    };
    void refusalOf(load);
  }, [rule_file]);
  return { picture: floor.picture, zones };
}
