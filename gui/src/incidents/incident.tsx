// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, signal } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import type { CameraFrames, CheckCondition, IncidentAnswer, IncidentCourse, IncidentRecord } from "../api/types";
import type { MapPicture, MapZone } from "../map/shapes";
import { href } from "../route";
import { layoutName, PLAIN_GRID, readLayout } from "../state/layout";
import { MapFloor } from "../state/map_floor";
import { statementsIn } from "../state/statements";
import { Timeline, upTo } from "../state/timeline";
import { checksIn, type RobotCheck } from "../state/written_checks";
import { TimeAxis } from "../try/axis";
import { CourseOfCheck } from "../try/check_courses";
import { PathMap } from "../try/path_map";
import { zonesAt } from "../try/try_result";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { DataTable } from "../ui/data_table";
import { Notes, Problem } from "../ui/notice";
import { counted, moment, NS_PER_MS, readable, sizeWords } from "../ui/numbers";
import { furtherWords, missingWords, sinceMoment, sinceTrigger, sumOf, valueWords, windowWords } from "./missing_words";

/** Why an incident was recorded, and what is missing of it. */
export function IncidentFacts({ incident, ground }: { incident: IncidentAnswer; ground: Ground }) {
  const { record, units } = incident;
  const messages = sumOf(record.topics, "messages");
  const checks = ground.checks.value?.map(({ check }) => check);
  const values = valueWords(record.values, units, checks);
  const further = furtherWords(record, units, checks);
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

interface CourseProps {
  api: Api;
  incident: IncidentAnswer;
  course: IncidentCourse;
  ground: Ground;
}

/** For so long before and after its moment Play shows an incident, again and again. */
const LOOP_S = 5;

/** What happened around the moment of an incident: the camera and the path beside the values of its checks. */
export function CourseView({ api, incident, course, ground }: CourseProps) {
  const { trigger_s, duration_s, cameras, path } = course;
  // Charts count from its moment, where the slider is at first.
  const timeline = useMemo(() => {
    return new Timeline({ duration_s, bin_s: duration_s, first_bin_s: 0, path }, 1, trigger_s, [trigger_s]);
  }, [course]);
  const now = sinceMoment(timeline.time.value - trigger_s);
  const dotsS = useMemo(() => [trigger_s], [course]);
  const known = ground.checks.value;
  const checks = useMemo(() => known ?? standIns(incident.record.values), [known, incident]);
  return (
    <section class="incident-course" aria-label="Around the moment">
      <h2>Around the moment</h2>
      <Notes notes={course.notices} />
      <TimeAxis
        timeline={timeline}
        label="Time around the moment (s)"
        words={now}
        said={now}
        loopS={[Math.max(trigger_s - LOOP_S, 0), Math.min(trigger_s + LOOP_S, duration_s)]}
        buttons={
          <Button
            label="To the moment"
            class="small"
            disabled={now === "the moment"}
            onClick={() => timeline.goTo(trigger_s)}
          />
        }
        beside={
          (cameras.length > 0 || path.length > 1) && (
            <>
              {cameras.length > 0 && <Camera {...{ api, cameras, timeline }} name={incident.name} />}
              {path.length > 1 && (
                <PathMap
                  {...{ timeline, path, dotsS }}
                  dotsAre="The dot is the moment."
                  picture={ground.picture.value}
                  zones={ground.zones.value}
                  isNear
                />
              )}
            </>
          )
        }
      >
        {checks.map((one) => (
          <div key={one.words}>
            <CourseOfCheck {...{ api, one, timeline }} bag={incident.name} isValueOnly={known === null} />
          </div>
        ))}
        {known === null && (
          <p class="quiet">The rules of then are not in this project, so that the thresholds are not known here.</p>
        )}
        <p class="quiet">
          0 s is the moment. Play goes from {LOOP_S} s before to {LOOP_S} s after, again and again.
        </p>
      </TimeAxis>
    </section>
  );
}

/** Checks that read what the condition read, where nobody knows what it was compared with. */
function standIns(values: IncidentRecord["values"]): GroundCheck[] {
  return Object.entries(values)
    .filter(([signal]) => !signal.startsWith("@"))
    .map(([words, value]) => {
      const at = words.indexOf(" ");
      const [topic, property] = [words.slice(0, at), words.slice(at + 1)];
      const [op, limit] = typeof value === "string" ? (["=", `"${value}"`] as const) : ([">", value ?? 0] as const);
      const check: CheckCondition = { kind: "check", topic, property, op, value: limit };
      return { check, condition: check, words };
    });
}

interface CameraProps {
  api: Api;
  name: string;
  cameras: readonly CameraFrames[];
  timeline: Timeline;
}

/** The frame that a camera had sent last at the time of the slider. */
function Camera({ api, name, cameras, timeline }: CameraProps) {
  const [topic, setTopic] = useState(cameras[0]?.topic ?? "");
  const [problem, setProblem] = useState("");
  const { times_s = [], numbers = [] } = cameras.find((one) => one.topic === topic) ?? {};
  const at = Math.max(upTo(times_s, (t) => t <= timeline.time.value) - 1, 0);
  const number = numbers[at];
  const source = `api/incident/frame?${new URLSearchParams({ name, topic, number: String(number) })}`;
  const when = `${sinceMoment((times_s[at] ?? 0) - timeline.zeroS)}, ${at + 1} of ${numbers.length}`;
  return (
    <figure class="camera">
      <figcaption>
        {cameras.length === 1 ? (
          <strong>{topic}</strong>
        ) : (
          <Choice
            label="Camera"
            value={topic}
            choices={cameras.map((one) => one.topic)}
            choose={(chosen) => {
              setProblem("");
              setTopic(chosen);
            }}
          />
        )}
        {number !== undefined && <span class="quiet">{when}</span>}
      </figcaption>
      <Problem text={problem} />
      {number === undefined && <p class="quiet">No frame within the window.</p>}
      {number !== undefined && !problem && (
        <img src={source} alt={`${topic}, ${when}`} onError={() => void api.problemAt(source).then(setProblem)} />
      )}
    </figure>
  );
}

type GroundCheck = Pick<RobotCheck, "check" | "condition" | "words">;

/** What an incident is drawn on. */
interface Ground {
  picture: Signal<MapPicture | null>;
  zones: Signal<readonly MapZone[]>;
  /** The checks of the rule; null where the project has not its text of then. */
  checks: Signal<readonly GroundCheck[] | null>;
}

/** The map of the rule file that recorded an incident, and its zones and checks if it holds the same text as then. */
export function useRuleGround(api: Api, incident: IncidentAnswer): Ground {
  const { rule_file, is_same_text, record } = incident;
  const zones = useMemo(() => signal<readonly MapZone[]>([]), []);
  const checks = useMemo(() => signal<readonly GroundCheck[] | null>(null), []);
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
      const asked = { text, name: rule_file, profile_text: null };
      const document = await api.ask("POST /api/document", asked);
      // The line is that of the Record in the rule.
      const rule = statementsIn(document).findLast(({ kind, line = 0 }) => kind === "rule" && line <= record.line);
      checks.value = checksIn(rule ? [rule] : []);
      const { rules } = await api.ask("POST /api/zones", asked);
      zones.value = zonesAt(rules, [record.rule]);
    };
    void refusalOf(load);
  }, [rule_file]);
  return { picture: floor.picture, zones, checks };
}
