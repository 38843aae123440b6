// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Written by scripts/make_api_types.py (make docs); change the structs and records in Python instead.

/** The protocol of the web socket. */
export const PROTOCOL_VERSION = 2;

/** The properties of a topic that changed, beside the rate of its source. */
export interface AccuracyNeeds {
  source_hz: number | null;
  properties: PropertyNeeds[];
  notices: string[];
}

export type Action =
  | SetStatement
  | WithinStatement
  | RecordStatement
  | ParameterStatement
  | CallStatement
  | NotifyStatement;

/**
 * Time since the newest message received, in s: mean, 95th percentile and maximum over time.
 *
 * It counts from the first message to the end of A. `unseen_s` are the seconds before that, from A's
 * first message of the topic on, in which the operator had nothing.
 */
export interface Age {
  mean_s: number;
  p95_s: number;
  max_s: number;
  unseen_s: number;
}

/** Parameters and services that the profile allows rules: the parameters of each node, and services. */
export interface Allowed {
  parameters: Record<string, string[]>;
  calls: string[];
}

/** All terms hold; at least one term. */
export interface AndCondition {
  kind: "and";
  terms: Condition[];
}

/**
 * A map or image; `GET /api/background/picture?kind=…&name=…` is its picture, always PNG.
 *
 * `hash` is that of its files, to see whether they changed; `metres_per_pixel` is null for an image.
 * The lower left corner of the picture lies at (`x`, `y`) in metres, turned about it by `yaw_rad`.
 */
export interface Background {
  kind: BackgroundKind;
  name: string;
  hash: string;
  width_px: number;
  height_px: number;
  metres_per_pixel: number | null;
  x: number;
  y: number;
  yaw_rad: number;
}

/** A map, image or recording of the project. */
export interface BackgroundChoice {
  kind: ChoiceKind;
  name: string;
}

export type BackgroundKind = "map" | "image";

/** A map or image by its name in the project. */
export interface BackgroundRequest {
  kind: BackgroundKind;
  name: string;
}

/** Maps, images and recordings that zones can be drawn on. */
export interface BackgroundsAnswer {
  choices: BackgroundChoice[];
}

/** A bag of the project. */
export interface BagRequest {
  bag: string;
}

/**
 * The condition of one If, at its place in the rule file number `file`, with its checks in order.
 *
 * `held_s` is for how long its state has been the same, `None` where that is not told. `times` are in
 * the order in which they end in the text.
 */
export interface BlockStatus {
  file: number;
  line: number;
  column: number;
  state: Truth;
  checks: [line: number, column: number, state: Truth, value: number | string | null][];
  held_s?: number;
  times?: [line: number, column: number, state: Truth, held_s: number | null][];
}

/** A rule, or its Else, by the line that it begins at, and what it turned to when; it starts unknown. */
export interface BlockTurns {
  rule: string;
  line: number;
  turns: [number, Truth][];
}

export type Bound = number | Tier;

/**
 * How many messages per s keep within `bound`, with hold and with dead reckoning.
 *
 * `reckoned_hz` is null where nothing can be reckoned. A wider bound may need a message more by chance: it
 * counts as the tighter one does.
 */
export interface BoundNeed {
  bound: number;
  hold_hz: number;
  reckoned_hz: number | null;
}

/**
 * Reason for the bound of one property; `rule` and `line` name the block where one decided.
 *
 * `UNKNOWN`: the block is in doubt. Its bound counts if the plan has one of the property, else every
 * message up to the rate passes because of the doubt.
 */
export interface BoundReason {
  reason: Reason;
  rule: string | null;
  line: number | null;
}

/**
 * How a bound was kept while it was in force, over the messages of the source that have a value.
 *
 * Of a property with many bounds, a record stands for several, and `bound` is the widest of them.
 * `worst` is the estimate's largest finite error after one, `None` where it never had one. `broken`
 * counts those after which the estimate was more than the bound off, or said nothing. `last` is the error
 * after the newest message, infinite where the estimate, or the message, says nothing. A message without a
 * value is judged by no bound.
 */
export interface BoundRecord {
  bound: number;
  worst: number | null;
  broken: number;
}

/** `Call service [true | false]` in a rule. */
export interface CallStatement {
  kind: "call";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  service: string;
  argument?: boolean | null;
}

/** The frames of a camera's topic, at most 300: when each arrived, and its number in the incident. */
export interface CameraFrames {
  topic: string;
  times_s: number[];
  numbers: number[];
}

/** `CheckValue topic property op value [Until op value]`; `op` is one of `> < >= <= = !=`. */
export interface CheckCondition {
  kind: "check";
  topic: string;
  property: string;
  op: Operator;
  value: Compared;
  until?: UntilValue | null;
  offset?: number;
  end_offset?: number;
}

/**
 * The values of a check's property in bins of `bin_s`, and what held when; times are since the start.
 *
 * Of an incident that is the start of its window, and `duration_s` is as long as that.
 * `least` and `greatest` are those that the check met in each bin, null where it was unknown
 * throughout. Of one that compares with no number, `words` say what it read from when on, null where that
 * was unknown. `check` and `condition` say what each turned to when; all these turn at most 2000 times.
 */
export interface CheckCourse {
  duration_s: number;
  bin_s: number;
  least: (number | null)[];
  greatest: (number | null)[];
  words: [number, string | null][];
  check: BlockTurns;
  condition: BlockTurns;
  notices: string[];
}

/**
 * A check over a bag, and the `For` or `Within` on it.
 *
 * `run` names the work in `Progress` messages of `/ws`. `profile_text` says how levels are read.
 */
export interface CheckCourseRequest {
  bag: string;
  condition: Condition;
  profile_text?: string | null;
  run?: string;
}

export type ChoiceKind = "map" | "image" | "bag";

/**
 * A topic that a robot accepts, as the robot's end knows it.
 *
 * `type_name` is what the robot's own nodes subscribe with, `None` where none does or `problem` says
 * why nothing is delivered. Of the messages that were `received`, some were `delivered`, some
 * `too_old` and some `refused`. `age_ms` is how old the last one was when it arrived, at most.
 */
export interface CommandTopic {
  topic: string;
  type: string | null;
  problem: string | null;
  received: number;
  delivered: number;
  too_old: number;
  refused: number;
  age_ms: number | null;
}

export type Compared = number | string;

export type Condition = CheckCondition | AndCondition | OrCondition | NotCondition | TimedCondition;

/** The pushed rules hold for good. */
export interface ConfirmAnswer {
  state: "confirmed";
  hash: string;
}

/** A file to be copied; `new_name` must not exist yet. */
export interface CopyRequest {
  name: string;
  new_name: string;
}

/** Rectangles that share no area and hold the polygon; `over_m2` is what they cover beside it. */
export interface CoverAnswer {
  rectangles: ZoneRectangle[];
  polygon_m2: number;
  over_m2: number;
}

/** The corners of a polygon, in its order. */
export interface CoverRequest {
  corners: [number, number][];
  max_rectangles?: number;
}

/**
 * The curve at rising rates up to the source's, and the six levels where it bends.
 *
 * Without points, no field of the topic ever changed; without `tiers_hz`, none can be proposed.
 */
export interface Curve {
  source_hz: number | null;
  points: LossPoint[];
  tiers_hz: [number, number, number, number, number, number] | null;
  notices: string[];
}

/** A topic of a bag; `run` names the job in `Progress` messages of `/ws`. */
export interface CurveRequest {
  bag: string;
  topic: string;
  run?: string;
}

/** Delete statement `id` with its own comments. */
export interface Delete {
  kind: "delete";
  id: string;
}

/** A file to be removed; `base_hash` is what the page keeps for its *Undo*. */
export interface DeleteRequest {
  name: string;
  base_hash: string;
}

/** Differences for a robot with the new text, in sentences; which of the two has errors of syntax. */
export interface DifferenceAnswer {
  differences: string[];
  old_parses: boolean;
  new_parses: boolean;
}

/** Two texts of a rule file. */
export interface DifferenceRequest {
  old_text: string;
  new_text: string;
}

/**
 * A rule file as an editor holds it, with the text of its profile; findings call them by the names.
 *
 * Texts come and go whole.
 */
export interface Draft {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
}

/** The draft of a file, null where all is saved. */
export interface DraftAnswer {
  draft: FileDraft | null;
}

/**
 * The draft of the file `name`, called `id`; null where it has none any more.
 *
 * `root_hash` is of the project that the page shows: behind one address may be another by now.
 * `known_ids` are the drafts that the page knows, which this one takes the place of. `discarded` is a
 * content that somebody gave up, null for none: of rules a version of it is kept.
 */
export interface DraftRequest {
  name: string;
  root_hash: string;
  id: string;
  known_ids: string[];
  draft: Unsaved | null;
  discarded?: string | null;
}

/** A file with a draft; it need not be there. Times count since 1970. */
export interface DraftedFile {
  name: string;
  changed_at_ms: number;
}

/** The files with drafts, by name. */
export interface DraftsAnswer {
  drafts: DraftedFile[];
}

/**
 * Where the robot of a recording was: seconds since its start, x and y in metres.
 *
 * `source` is the topic that says so, `has_pose` whether rules can read the place from it, `frame` the
 * frame of its places, empty where it names none.
 * `notices` say what could not be read.
 */
export interface DrivenPath {
  path: [number, number, number][];
  source: string;
  has_pose: boolean;
  frame: string;
  notices: string[];
}

/** Put a copy of statement `id`, as it is written, behind it; a rule's copy has a name of its own. */
export interface Duplicate {
  kind: "duplicate";
  id: string;
}

/** A unit of time; the value is its spelling. */
export type DurationUnit = "ms" | "s" | "min";

/** A time in `unit`. */
export interface DurationValue {
  value: number;
  unit: DurationUnit;
}

export type Edit = Replace | Insert | Delete | Duplicate | Move | NewZone | MoveZone | ResizeZone | Substitute;

/** The new text and its document. */
export interface EditAnswer {
  text: string;
  document: RuleDocument;
}

/**
 * Edits that are all made in their order, or none of them.
 *
 * Each speaks of the text that those before it made: its ids, indices and offsets.
 */
export interface EditRequest {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
  edits: Edit[];
}

/** The body of every answer that is an error. */
export interface ErrorAnswer {
  error: Problem;
}

/**
 * How large an error was over time, in the field's unit.
 *
 * `rmse` is the root of the mean square over time, `maximum` the largest magnitude. The relative ones
 * are shares of the field's range (0.02 is 2 %), `None` where the field never changed.
 */
export interface ErrorSize {
  rmse: number;
  max: number;
  relative_rmse: number | null;
  relative_max: number | null;
}

/** Kind of a change; the value is its name in JSON. */
export type EventKind = "rate" | "rule" | "rules";

/** Relayed topics while there are no valid rules; the value is its name in JSON. */
export type Fallback = "full" | "readable" | "off";

/**
 * How far a fetch is: `got_bytes` of `total_bytes`, those of earlier attempts included.
 *
 * `level_hz` is the grid of the skeleton that is whole for all topics of small messages: 1, 2, 4 … Hz;
 * `None` before the first, infinite once all of their messages are there, so that large ones remain.
 * `rate_bytes_per_s` is that of the last seconds; `waits_for` says why nothing comes, where that is so.
 */
export interface FetchProgress {
  got_bytes: number;
  total_bytes: number;
  rate_bytes_per_s: number;
  level_hz: number | null;
  waits_for: string | null;
}

/**
 * How far a fetch is, of which all but what is missing stays when it ends early.
 *
 * `problem` is why it failed, else empty; `kept` what the project calls it once done.
 */
export interface FetchState {
  robot: string;
  name: string;
  state: "running" | "done" | "cancelled" | "failed";
  progress: FetchProgress;
  problem: string;
  kept: string | null;
}

/**
 * Fetches that were asked for since the start of the server.
 *
 * `heard` are the robots that are there now, which costs the link nothing; none before they were asked.
 */
export interface FetchesAnswer {
  fetches: FetchState[];
  heard: string[];
}

/** The content of a field; the value is its name in JSON. */
export type FieldKind = "number" | "text" | "truth";

/** The text of a file with its SHA-256, which a later PUT names. */
export interface FileAnswer {
  name: string;
  text: string;
  hash: string;
}

/** A draft; its `id`, which a page chose, is another after each change. Times count since 1970. */
export interface FileDraft {
  content: string;
  beside: string;
  base_hash: string | null;
  id: string;
  changed_at_ms: number;
}

/** Kind of a file to the Ruler; the value is its name in JSON. */
export type FileKind = "rules" | "profile" | "bag" | "map" | "layout" | "image";

/** Load of rules in their worst case, and the budget. */
export interface FileLoad {
  kb_per_s: number;
  budget_kb_per_s: number;
}

/** The SHA-256 of what is on disk, null where nothing is. */
export interface FileOnDisk {
  hash: string | null;
}

/**
 * Load and last try of a rule file.
 *
 * `load` is null where the rules have errors or their profile does not say all that it takes.
 */
export interface FileSummary {
  load: FileLoad | null;
  last_try: LastTry | null;
}

/**
 * A file by its name in the project, with `/` between folders. A bag may be a folder.
 *
 * `changed_at_s` is when it was changed last, in seconds since 1970.
 */
export interface FoundFile {
  name: string;
  kind: FileKind;
  size_bytes: number;
  changed_at_s: number;
}

/** Frames of one arm, and the longest time without a new one, in s; it counts to the end of A. */
export interface Frames {
  frames: number;
  longest_blind_s: number;
}

/** Every message passes. */
export interface FullRate {
  kind: "full";
  value?: null;
}

/** A moment after the first at which the rule began to hold, and what its condition read. */
export interface FurtherMoment {
  triggered_ns: number;
  values: Record<string, number | string | null>;
  time: string;
}

export type HealthLevel = "ok" | "warn" | "error" | "stale";

/**
 * How bad something is, what in a few words, and all that is known of it.
 *
 * It says what `testudo top` and /diagnostics do.
 */
export interface HealthWords {
  level: HealthLevel;
  summary: string;
  message: string;
}

/**
 * The first message on `/ws`; a page that knows another protocol asks to be reloaded.
 *
 * `only_watches` is whether the page may change neither files nor robots.
 */
export interface Hello {
  kind: "hello";
  version: string;
  only_watches: boolean;
  protocol: number;
}

/** A rate in Hz, 0 … 1e6. */
export interface Hz {
  kind: "hz";
  value: number;
}

/**
 * The record of an incident, and the units of the values in that, where they are known.
 *
 * `rule_file` is the project's file of the name that the robot had the rule in, null where it has none,
 * and `is_same_text` whether that holds the same text as then.
 */
export interface IncidentAnswer {
  name: string;
  size_bytes: number;
  record: IncidentRecord;
  units: Record<string, string>;
  rule_file: string | null;
  is_same_text: boolean;
}

/**
 * Content of an incident over time, in seconds since the window's start; the trigger is at `trigger_s`.
 *
 * `path` is `[seconds, x, y]` in metres where a topic says where the robot was. `notices` say what
 * could not be read.
 */
export interface IncidentCourse {
  duration_s: number;
  trigger_s: number;
  cameras: CameraFrames[];
  path: [number, number, number][];
  notices: string[];
}

/** An incident by its name in the project; `run` names the job in `Progress` of `/ws`. */
export interface IncidentCourseRequest {
  name: string;
  run?: string;
}

/**
 * Which rule recorded what, when, and what is missing.
 *
 * `rule` is the label of the block, in line `line` of the file `path`; `values` are what its
 * condition read. Stamps are the clock's, `rules_sha256` is that of the texts of all rules.
 * It began to hold at so many `moments` of the incident; of a great many, not all are in
 * `further_moments`.
 */
export interface IncidentRecord {
  name: string;
  rule: string;
  file: string;
  line: number;
  triggered_ns: number;
  from_ns: number;
  to_ns: number;
  values: Record<string, number | string | null>;
  rules_sha256: string;
  topics: Record<string, IncidentTopic>;
  latched: LatchedSample[];
  missing: Missing[];
  moments?: number;
  further_moments?: FurtherMoment[];
}

/**
 * Cost of recording on a running robot, and its results so far.
 *
 * `held_bytes` of at most `memory_bytes` are kept of `topics` topics for what may happen, and
 * `ring_bytes` of at most `ring_max_bytes` on disk, which is `None` if memory is all there is.
 * Incidents are `open` now, were `recorded` whole, or `failed` since the start; `problem` says why
 * the last one could not be written, until the next one can. Of their messages, `dropped` arrived faster
 * than the disk took them, and so many are `missing` in those that ended, whatever the reason. At so many
 * `further_moments` a rule began to hold again and extended its incident.
 */
export interface IncidentState {
  held_bytes: number;
  memory_bytes: number;
  topics: number;
  open: number;
  recorded: number;
  failed: number;
  problem: string | null;
  ring_bytes: number;
  ring_max_bytes: number | null;
  dropped?: number;
  missing?: number;
  further_moments?: number;
}

/** Content of an incident for one topic. */
export interface IncidentTopic {
  type: string;
  messages: number;
  bytes: number;
}

/** Incidents, the newest first; `has_more` is whether older ones are left out. */
export interface IncidentsAnswer {
  incidents: ListedIncident[];
  has_more: boolean;
}

/**
 * The newest incidents first; `problem` is why they are not known, else empty.
 *
 * `kept` are those that were fetched, by name, with what the project calls them.
 */
export interface IncidentsOfRobot {
  robot: string;
  problem: string;
  incidents: RemoteIncident[];
  kept: Record<string, string>;
}

/** Put `statement` before number `index` of `collection`; its length puts it at the end. */
export interface Insert {
  kind: "insert";
  collection: string;
  index: number;
  statement: Statement;
}

/** The one to end, or to forget where it has ended. */
export interface KeepEndRequest {
  run: string;
}

/**
 * The `number`-th incident of a try.
 *
 * `run` tells it from others that are being kept; `title` is what the page calls it.
 */
export interface KeepRequest {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
  bag: string;
  run?: string;
  number: number;
  title?: string;
}

/**
 * How far the keeping of an incident is, `share` 0 … 1.
 *
 * `kept` is what the project calls it once done, `problem` why it failed, else empty.
 */
export interface KeepState {
  run: string;
  title: string;
  bag: string;
  state: "running" | "done" | "failed";
  share: number;
  kept: string | null;
  problem: string;
}

/** `KeepAtLeast topic hz`. */
export interface KeepStatement {
  kind: "keep";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  topic: string;
  hz: number;
}

/** Incidents that are being kept, the oldest first. */
export interface KeepsAnswer {
  keeps: KeepState[];
}

/**
 * A topic, its type where anybody knows it, else the one that its name stands for, and who names it.
 *
 * `properties` are those that checks read, `bounds` those that only a `KeepWithin` can name.
 * `source_hz` is the profile's, `levels_hz` the lowest and highest rate of each of its six levels.
 * `used_by` are the labels of the rules that name the topic, and `default` for statements outside rules.
 * `is_published`: a robot that is heard now has it.
 */
export interface KnownTopic {
  topic: string;
  type: string | null;
  properties: Property[];
  bounds: Property[];
  source: TopicSource;
  source_hz: number | null;
  levels_hz: [number, number][] | null;
  used_by: string[];
  is_published: boolean;
}

/** The machine or the link, by the `name` that checks have in the place of a topic. */
export interface KnownVitals {
  name: string;
  meaning: string;
  properties: Property[];
}

/**
 * The last try of rules: on the recording `bag`, or on those of a folder, which ends in `/`.
 *
 * `kb_per_s` is what was sent of relayed topics, `percent` how much less that is than the source. Times
 * count since 1970.
 */
export interface LastTry {
  bag: string;
  kb_per_s: number;
  percent: number;
  tried_at_ms: number;
}

/**
 * Kept rules last until the robot's runtime ends or its `files` change, of which it may have none.
 *
 * `writable_file` is the one that it lets kept rules be written to; where that is empty, `why_not` says
 * why.
 */
export interface LastingAnswer {
  files: string[];
  writable_file: string;
  why_not: string;
}

/**
 * A message from before the window that still counted in it; `stamp_ns` is when it arrived.
 *
 * In the incident it has the stamp of the window's start.
 */
export interface LatchedSample {
  topic: string;
  stamp_ns: number;
}

/** A property whose accuracy can have quality levels; the value is its name in a rule file. */
export type LevelledProperty = "position" | "orientation" | "positions";

/** A first guess from the rate alone. */
export interface LevelsAnswer {
  tiers_hz: [number, number, number, number, number, number];
}

/** A source of `source_hz` that needs six levels. */
export interface LevelsRequest {
  source_hz: number;
}

/**
 * State of the link at the robot's end; `None` for what was not measured yet.
 *
 * `capacity_kb_per_s` is what the link carries, `round_trip_ms` the least of the last seconds,
 * `outages` how often nothing arrived at the operator's end for more than a second and four round trips,
 * whether its connection was cut or it was started anew. Where it goes `by_datagrams`, `lost_percent` of
 * them were lost in the last minute. `sessions` counts how often an operator's end
 * joined that may lack what was sent before. All operator's ends that are there reckon the topics in
 * `predicted` where they are told how; `operators` are their numbers. Since the start
 * `sent_bytes` were put on the link, and `report_bytes` came back that say what arrived; for
 * `silent_s` nothing of them is known to have arrived at an operator's end.
 */
export interface LinkState {
  connected: boolean;
  capacity_kb_per_s: number | null;
  round_trip_ms: number | null;
  outages: number;
  datagrams: boolean;
  lost_percent: number | null;
  sent_bytes: number;
  report_bytes: number;
}

/**
 * A folder with an incident, by its `name` in the project.
 *
 * `problem` is why it cannot be read, and `incident` null then.
 */
export interface ListedIncident {
  name: string;
  size_bytes: number;
  problem: string;
  incident: RemoteIncident | null;
}

/**
 * The status of a robot, and what it does not say itself.
 *
 * `health` is that of the topics of which there is something to say. `accepted` are words for each topic
 * that is accepted of operators, `recording` those for what is recorded, both in the status's order.
 * `status_kb_per_s` is what its statuses themselves take of the link at most. `bounds` say of topics
 * which bound of each property holds, what decided it, and whether that is in doubt. `labels` are what
 * decisions call the blocks, and `checks` the words of the checks, in the order of the status; empty and
 * null until the robot's rules were read. `full_names` are those of topics that its rules call otherwise.
 */
export interface Live {
  kind: "live";
  node: string;
  status: RuntimeStatus;
  status_kb_per_s: number;
  health: Record<string, HealthWords>;
  accepted: string[];
  recording: string | null;
  bounds: Record<string, string[]>;
  labels: string[];
  checks: (RobotCheck | null)[];
  full_names: Record<string, string>;
}

/** The share of a topic's messages that was lost in the last seconds, and what to do about it. */
export interface LossBeforeRelay {
  percent: number;
  remedy: string;
}

/**
 * The topic at one rate: what it carries, and the RMSE of its worst field in percent of that's range.
 *
 * `error_percent` and `worst_field` are null where nothing known passed, `age_mean_s` where nothing.
 */
export interface LossPoint {
  rate_hz: number;
  kb_per_s: number;
  error_percent: number | null;
  worst_field: string | null;
  age_mean_s: number | null;
}

/** `.. to By topic property from .. to`: the rate goes to another one as a value goes to another one. */
export interface MarginValue {
  to: Rate;
  topic: string;
  property: string;
  from_value: number;
  to_value: number;
}

/**
 * A wish for a profile of what the robot's nodes publish now.
 *
 * `run` names it in the `Progress` messages of `/ws`.
 */
export interface MeasureLiveRequest {
  seconds: number;
  run?: string;
}

/** A bag to be measured; `run` names the job in `Progress` messages of `/ws`. */
export interface MeasureRequest {
  bag: string;
  run?: string;
}

/** Messages of `topic` that are not there, between two stamps; `messages` is `None` if unknown. */
export interface Missing {
  topic: string;
  reason: MissingReason;
  messages: number | null;
  from_ns: number;
  to_ns: number;
}

/** Why messages of a window are not in the incident. */
export type MissingReason = "memory" | "late" | "unpublished" | "ended" | "lost" | "disk" | "killed";

/**
 * The goal that OBI maximises; the value is its name on the command line.
 *
 * The first three are those of the thesis (Riccardi 2025): the sum of all rates within the intervals of the
 * levels (quper) or within [min_hz, max_hz] (budget), and that sum weighted by priority. `benefit` sums
 * quality instead of hertz, `maxmin` raises the lowest quality first, then the next (lexicographic).
 */
export type Model = "quper" | "budget" | "priority" | "benefit" | "maxmin";

/** Move statement `id`; `index` counts the other statements of `collection`. */
export interface Move {
  kind: "move";
  id: string;
  collection: string;
  index: number;
}

/** An edit: move all zones of rule `id` on `topic`, in whole centimetres. */
export interface MoveZone {
  kind: "zone_move";
  id: string;
  topic: string;
  dx: number;
  dy: number;
}

/** An edit: make `rectangles` the condition of rule `into`, or, if that is null, of a new one. */
export interface NewZone {
  kind: "zone_new";
  topic: string;
  rectangles: ZoneRectangle[];
  into?: string | null;
  label?: string;
}

/** The term does not hold. */
export interface NotCondition {
  kind: "not";
  term: Condition;
}

/** A text that a rule notifies while it holds, since `since_ns` on the robot's clock. */
export interface Notice {
  text: string;
  rule: string | null;
  since_ns: number;
}

/** `Notify "text"` in a rule. */
export interface NotifyStatement {
  kind: "notify";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  text: string;
}

/** Nothing passes. */
export interface OffRate {
  kind: "off";
  value?: null;
}

/** An incident by its name in the project. */
export interface OneIncidentRequest {
  name: string;
}

/** A comparison; the value is its spelling. */
export type Operator = ">" | "<" | ">=" | "<=" | "=" | "!=";

/** The rates, as loads; `download_text` is the rule file with numbers, null where not all fits. */
export interface OptimizeAnswer {
  feasible: boolean;
  budget_kb_per_s: number;
  situations: SituationLoad[];
  refusals: Refusal[];
  download_text: string | null;
}

/** A draft that needs rates; 409 with findings for rules with errors. */
export interface OptimizeRequest {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
  model?: Model;
  only_named?: boolean;
}

/** One of the terms holds; at least one term. */
export interface OrCondition {
  kind: "or";
  terms: Condition[];
}

/** `SetParameter node parameter value` in a rule; the value as a rule file spells it: 1 is no 1.0. */
export interface ParameterStatement {
  kind: "parameter";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  node: string;
  parameter: string;
  value: string;
}

/**
 * `begin … end` with its statements in order.
 *
 * `is_written` is false for statements and other text that stand outside any `begin … end`.
 */
export interface PlacedCollection {
  id: string;
  is_written: boolean;
  offset: number;
  end_offset: number;
  line: number;
  comments: string[];
  statements: Statement[];
}

/**
 * One finding of the checker.
 *
 * `statement` is the id of the statement it is about, `related` are those of others that it names.
 */
export interface PlacedFinding {
  code: string;
  severity: Severity;
  message: string;
  hint: string;
  line: number;
  column: number;
  end_line: number;
  end_column: number;
  offset: number;
  end_offset: number;
  fix: PlacedFix | null;
  profile_fix: ProfileFix | null;
  statement: string | null;
  related: string[];
}

/** Edit that mends a finding. */
export interface PlacedFix {
  title: string;
  edit: Substitute;
}

/** A rectangle of a rule. `is_shared` is whether a check of it bounds another rectangle as well. */
export interface PlacedZone {
  topic: string;
  rectangle: ZoneRectangle;
  is_shared: boolean;
}

/** A profile, its title, and what it describes with the source of its numbers. */
export interface Preset {
  title: string;
  about: string;
  text: string;
}

/** All presets, by title. */
export interface Presets {
  presets: Preset[];
}

/**
 * Why something was refused; `place` and `remedy` may be empty.
 *
 * `findings` say why, where rules with errors were refused.
 */
export interface Problem {
  message: string;
  place: string;
  remedy: string;
  findings: PlacedFinding[];
}

/** Why a table cannot be written; empty if it can. */
export interface ProfileCheckAnswer {
  problem: string;
}

/** The profile that the rule file `name` goes with, or none. */
export interface ProfileChosenRequest {
  name: string;
  profile: string | null;
}

/**
 * An entry to be written: `text` with `value` for `key` of `topic`.
 *
 * Null takes the key out. Everything else stays as it is written; a topic that the text lacks gets a table.
 */
export interface ProfileEntryRequest {
  text: string;
  topic: string;
  key: string;
  value: string | null;
  name?: string;
}

/** Fix of a finding in the profile: `value` for `key` of `topic`; `None` takes it out. */
export interface ProfileFix {
  topic: string;
  key: string;
  value: string | null;
  title: string;
}

/**
 * The name of a profile of the project; null where none is wanted, or none has to do with the rules.
 *
 * `gone` is the one that was chosen for the rules, where it is no longer there.
 */
export interface ProfileForAnswer {
  name: string | null;
  gone: string | null;
}

/** A rule file that needs a profile. */
export interface ProfileForRequest {
  text: string;
  name: string;
}

/** The text of a profile, to be read as a table. */
export interface ProfileParseRequest {
  text: string;
  name?: string;
}

/**
 * One topic by the name that the text has for it; null stands for a key that is not written.
 *
 * Sizes are in KB of 1000 B, rates in Hz; accuracies are in m, degrees and rad, beside the rates they need.
 */
export interface ProfileRow {
  topic: string;
  type?: string | null;
  message_kb?: number | null;
  source_hz?: number | null;
  tiers_hz?: [number, number, number, number, number, number] | null;
  priority?: number | null;
  min_hz?: number | null;
  max_hz?: number | null;
  tiers_m?: [number, number, number, number, number, number] | null;
  tiers_m_need_hz?: [number, number, number, number, number, number] | null;
  tiers_deg?: [number, number, number, number, number, number] | null;
  tiers_deg_need_hz?: [number, number, number, number, number, number] | null;
  tiers_rad?: [number, number, number, number, number, number] | null;
  tiers_rad_need_hz?: [number, number, number, number, number, number] | null;
  measured?: boolean | null;
}

/** The topics of a profile in the order of the text, and its budget in KB/s. */
export interface ProfileTable {
  rows: ProfileRow[];
  budget_kb_per_s: number | null;
}

/**
 * A table to be written: `base_text` with the values of the table.
 *
 * Comments, order and keys that the table does not show stay. Topics that are not in `rows` are removed.
 */
export interface ProfileWriteRequest {
  rows: ProfileRow[];
  budget_kb_per_s?: number | null;
  base_text?: string;
  name?: string;
}

/** How far the work `run` is, 0 … 1. */
export interface Progress {
  kind: "progress";
  run: string;
  share: number;
}

/**
 * The project; `opened` is the file that the command line named, if any.
 *
 * A bag is named by its folder, or by its file where it has no metadata. `ros` is whether the server can
 * reach ROS 2; `version` is that of SmartTestudo. `root_hash` tells folders of one name apart.
 */
export interface Project {
  root_name: string;
  root_hash: string;
  opened: string | null;
  files: FoundFile[];
  version: string;
  ros: boolean;
  has_more: boolean;
}

/**
 * A property that a check can read or a bound can be about.
 *
 * `words` are what it can be equal to, beside a number or a text: true and false, or constants.
 * `levels` are the loosest and the tightest bound of each of the six levels, where the profile has them.
 */
export interface Property {
  name: string;
  unit: string;
  meaning: string;
  kind: FieldKind;
  words: string[];
  levels: [number, number][] | null;
}

/** A property at the six bounds that are usual for it, the widest first, in `unit`: m, deg or rad. */
export interface PropertyNeeds {
  property: LevelledProperty;
  unit: string;
  points: BoundNeed[];
}

export type Push = Hello | Progress | Robots | Live;

/**
 * `staged`: the rules hold for `confirm_within_s`, and for good once `hash` is confirmed.
 *
 * `same`: nothing was sent, since the robot follows these rules already; `hash` is that of what it has.
 * A refusal by the robot is a 422 with the robot's own words.
 */
export interface PushAnswer {
  state: "staged" | "same";
  hash: string;
  confirm_within_s: number;
  differences: string[];
}

/**
 * Changes that a push would make, in sentences; `same` if the rules mean the same to the robot.
 *
 * `text_to_send` has numbers in the place of quality levels, since a robot may have no profile; `hash`
 * is its SHA-256. `robot_hash` is that of what the robot follows now. `differing_rules` are the numbers,
 * from 0 in the order of the text, of the rules that it does not follow as they are.
 */
export interface PushPreview {
  differences: string[];
  same: boolean;
  hash: string;
  robot_hash: string;
  text_to_send: string;
  differing_rules: number[];
}

/** Rules for a robot; those with errors are refused (409 with findings). */
export interface PushRequest {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
  node: string;
}

/**
 * Rules that were pushed to a robot, by their hash.
 *
 * A refusal by the robot is a 422 with the robot's own words.
 */
export interface PushedRequest {
  node: string;
  hash: string;
}

export type Rate = Hz | TierRate | FullRate | OffRate;

/** Text that does not parse, as it stands in the file; in a request, what to write. */
export interface RawStatement {
  kind: "raw";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  text: string;
}

/** Reason for a rate. */
export type Reason = "default" | "block" | "unknown" | "floor" | "budget" | "link" | "fallback" | "reload";

/** The name in the project of a recording that came as a file. */
export interface ReceivedAnswer {
  bag: string;
}

/** `Record "name" topics Before … After …` in a rule; no topics stand for all that the rules name. */
export interface RecordStatement {
  kind: "record";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  name: string;
  topics: string[];
  before: DurationValue;
  after: DurationValue;
}

/** A field by its path, as checks write it, and the first 50 texts that it had, sorted. */
export interface RecordedField {
  path: string;
  kind: FieldKind;
  texts: string[];
}

/** Fields of a topic in its first 20 000 messages; those of named elements are after those of any. */
export interface RecordedWords {
  fields: RecordedField[];
}

/** A topic of a bag; `run` names the work in `Progress` messages of `/ws`. */
export interface RecordedWordsRequest {
  bag: string;
  topic: string;
  run?: string;
}

/** Its topics by name, how long it is, and a rule file that relays every message of them. */
export interface RecordingAnswer {
  topics: string[];
  duration_s: number;
  rules_text: string;
}

/** Why a part does not fit; `rule` is the statement's id, null for the defaults. */
export interface Refusal {
  rule: string | null;
  message: string;
  needs_kb_per_s: number;
  repairs: Repair[];
}

/**
 * An incident on a robot, as its list says; `name` is that of its folder.
 *
 * `label` is the name in the `Record`, `rule` that of the block. Stamps are the robot's clock.
 * It began to hold at so many `moments`, the first at `triggered_ns`. `missing` are the reasons
 * (`MissingReason`) for which messages of the window are not there.
 */
export interface RemoteIncident {
  robot: string;
  name: string;
  label: string;
  rule: string;
  triggered_ns: number;
  from_ns: number;
  to_ns: number;
  messages: number;
  size_bytes: number;
  is_read: boolean;
  missing: string[];
  moments: number;
}

/** A file with another name; `base_hash` is what the page knows to be in `name`. */
export interface RenameRequest {
  name: string;
  new_name: string;
  base_hash: string;
}

/**
 * One way to make a part fit: edits of the rules' text, or a greater budget in KB/s.
 *
 * `sentence` is the full text, `title` a short one for a button.
 */
export interface Repair {
  title: string;
  sentence: string;
  edits: Substitute[];
  budget_kb_per_s: number | null;
}

/**
 * Write `statement` in the place of statement `id`; only what differs is touched.
 *
 * Comments stay where `statement.comments` is null; a list replaces those directly above.
 */
export interface Replace {
  kind: "replace";
  id: string;
  statement: Statement;
}

/** An edit: give zone number `index` of rule `id` other sides. */
export interface ResizeZone {
  kind: "zone_resize";
  id: string;
  index: number;
  rectangle: ZoneRectangle;
}

/**
 * A check of the robot's rules, in the words of its text, and the rule that it is in.
 *
 * What it says of a value does not depend on its place, so the words find it in another text.
 */
export interface RobotCheck {
  rule: string;
  topic: string;
  property: string;
  op: Operator;
  limit: Compared;
}

/**
 * The least and the greatest value of check number `check` in bins of `bin_s`, from `first_bin_s`.
 *
 * Null where no status said a value. Of a check that compares with no number, `words` say what it read
 * from when on. `turns` say what the check turned to when.
 */
export interface RobotCheckValues {
  check: number;
  bin_s: number;
  first_bin_s: number;
  least: (number | null)[];
  greatest: (number | null)[];
  words: [number, string | null][];
  turns: [number, Truth][];
}

/**
 * Rules and checks of a robot; times are since `window_s` ago, all is unknown before `heard_from_s`.
 *
 * `checks` are at most 100, and none until the robot's rules were read.
 */
export interface RobotChecksAnswer {
  window_s: number;
  heard_from_s: number;
  rules: BlockTurns[];
  checks: RobotCheck[];
  values: RobotCheckValues | null;
}

/**
 * The last `window_s` of a robot, and the values of one check.
 *
 * `check` is its number in the answer; null asks for none.
 */
export interface RobotChecksRequest {
  node: string;
  window_s: number;
  check?: number | null;
}

/** A change of a topic's rate, a rule's state, or all rules; `because` is what decided the rate. */
export interface RobotEvent {
  s_ago: number;
  kind: EventKind;
  name: string;
  before: string;
  after: string;
  because: string;
}

/**
 * Events since `since_s_ago`, the newest first; `left_out` older ones are not told.
 *
 * `path` is `[seconds ago, x, y]` in metres, the oldest first, by the checks of the rules that read
 * `pose_topic`; null where none does.
 */
export interface RobotHistoryAnswer {
  since_s_ago: number;
  events: RobotEvent[];
  left_out: number;
  path: [number, number, number][];
  pose_topic: string | null;
}

/** An incident by the name of its robot and its own. */
export interface RobotIncidentRequest {
  robot: string;
  name: string;
}

/**
 * Incidents of each robot that is heard over the link.
 *
 * `is_linked` is whether there is a link at all, `problem` why it carries nothing, else empty.
 */
export interface RobotIncidentsAnswer {
  is_linked: boolean;
  problem: string;
  robots: IncidentsOfRobot[];
}

/** The robot that is known no more, until it is heard again. */
export interface RobotRemoved {
  node: string;
}

/** A robot by its node. */
export interface RobotRequest {
  node: string;
}

/** The topics that a robot relays, a rule file that relays every message of them, and their profile. */
export interface RobotStartAnswer {
  topics: string[];
  rules_text: string;
  profile_text: string;
}

/**
 * One robot of a list; `label` is what people call it, `health` null where all is well.
 *
 * `is_heard` is false once it has been silent for longer than it should be; `heard_s_ago` is the time
 * since its last status. `topics` are counted, `recorded` the incidents on its disk since it started.
 */
export interface RobotSummary {
  node: string;
  label: string;
  is_heard: boolean;
  heard_s_ago: number;
  health: HealthWords | null;
  rules: RulesInForce;
  topics: number;
  budget_kb_per_s: number | null;
  out_kb_per_s: number;
  link: LinkState | null;
  recorded: number;
}

/**
 * The robots, when something changes and every two seconds.
 *
 * `problem` is why ROS cannot be reached, null if it can.
 */
export interface Robots {
  kind: "robots";
  problem: string | null;
  robots: RobotSummary[];
}

/**
 * A rule file as statements and findings.
 *
 * An `id` names a statement of exactly this text. A `key` comes from the statement's words: it survives
 * edits elsewhere and moves, so that block positions can be kept by it.
 */
export interface RuleDocument {
  collections: PlacedCollection[];
  findings: PlacedFinding[];
  parses: boolean;
}

/**
 * `[Disabled] [Rule "name" [Priority n]] If … Then … [Else …]`; in JSON `otherwise` is `else`.
 *
 * `label` (answers only) is what findings and decisions call the rule.
 */
export interface RuleStatement {
  kind: "rule";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  condition: Condition;
  then: Action[];
  else: Action[];
  name?: string | null;
  priority?: number;
  is_disabled?: boolean;
  label?: string;
}

/**
 * One version; `saved_at_ms` counts since 1970.
 *
 * `changes` is what a robot does otherwise than with the version before: empty where only comments or
 * layout differ, null where none is before it or it was not compared. `parses` is whether it is without
 * errors of syntax, null where it was not read.
 */
export interface RuleVersion {
  id: string;
  saved_at_ms: number;
  size_bytes: number;
  changes: string[] | null;
  parses: boolean | null;
}

/**
 * The zones of the rule `id`, in any of which it may hold.
 *
 * `others` are its checks that bound no zone, as text; `holds_elsewhere` is whether it can hold outside
 * its zones; `is_too_mixed` says that its condition is too mixed to be drawn.
 */
export interface RuleZones {
  id: string;
  label: string;
  zones: PlacedZone[];
  others: string[];
  holds_elsewhere: boolean;
  is_too_mixed: boolean;
}

/**
 * The files that the rules came from, and the SHA-256 of their text in hexadecimal.
 *
 * `waits_s` is how long pushed rules still hold unless they are confirmed; `None` where none wait.
 * `problem` says why the rule files cannot be used as they are now; the rules in force are others.
 * `fallback` is there while there are no valid rules.
 */
export interface RulesInForce {
  files: string[];
  sha256: string;
  origin: RulesOrigin;
  waits_s: number | null;
  problem?: string;
  fallback?: Fallback;
}

/** Where the rules in force come from; the value is its name in JSON. */
export type RulesOrigin = "files" | "pushed" | "waiting" | "fallback";

/**
 * All of a runtime: its node, its rules, the link, itself, and its topics by source.
 *
 * `robot` is the robot's name on its link, empty without one; nodes of several robots may be called alike;
 * `run` tells their runs apart.
 * `stamp_ns` is the node's clock, `uptime_s` real time since the start, `cpu_percent` of one core
 * over the last second, `memory_mb` what is resident. `status_hz` is how often a status comes,
 * `blocks` has the states of the conditions: of the first `MOST_BLOCKS`, `blocks_left_out` counts the
 * others.
 */
export interface RuntimeStatus {
  robot?: string;
  node: string;
  run?: string;
  stamp_ns: number;
  uptime_s: number;
  status_hz: number;
  rules: RulesInForce;
  budget_kb_per_s: number | null;
  floors_break_budget: boolean;
  cpu_percent: number | null;
  memory_mb: number | null;
  topics: Record<string, TopicStatus>;
  blocks: BlockStatus[];
  blocks_left_out?: number;
  link?: LinkState;
  accepted?: Record<string, Omit<CommandTopic, "topic">>;
  incidents?: IncidentState;
  notices?: Notice[];
  in_kb_per_s: number;
  out_kb_per_s: number;
  fallback: boolean;
}

/** The SHA-256 of what is on disk now; `note` is why no version of it is kept, empty if one is. */
export interface SaveAnswer {
  hash: string;
  note: string;
}

/**
 * A text to be saved; `base_hash` is what the editor read; null where the file must not exist yet.
 *
 * `draft_ids` are the drafts of the file that the editor knows: the text takes their place, too.
 */
export interface SaveRequest {
  name: string;
  text: string;
  base_hash?: string | null;
  draft_ids?: string[];
}

/** `SetFrequency topic rate [margin]`: a default, or in a rule, without `id` and `key`. */
export interface SetStatement {
  kind: "set";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  topic: string;
  rate: Rate;
  margin?: MarginValue | null;
}

/** How much a finding matters; only errors stop a file from being used. */
export type Severity = "error" | "warning" | "info";

/**
 * How an operator who holds the last value saw the crossings of a threshold.
 *
 * `late_mean_s` and `late_max_s` are over those that were late; `None` without one. Of a check of a
 * text or a state, `wrong_s` is for how long the operator believed something else, or knew nothing yet.
 */
export interface Sightings {
  in_time: number;
  late: number;
  missed: number;
  late_mean_s: number | null;
  late_max_s: number | null;
  wrong_s?: number;
}

/** Why nothing is received of a relayed topic. The first that holds counts. */
export type Silence =
  | "Off"
  | "no publisher"
  | "cannot be relayed"
  | "no subscriber"
  | "incompatible QoS"
  | "no message yet"
  | "source is silent";

/** Which situation loads belong to; the value is its name in JSON. */
export type SituationKind = "defaults" | "rule" | "worst";

/**
 * The loads of all relayed topics: by default, in one rule's block, or in the worst case.
 *
 * `rules` are the ids of the statements that hold, `state` an example of values (`"/odom pose_x"`).
 */
export interface SituationLoad {
  kind: SituationKind;
  title: string;
  rules: string[];
  state: Record<string, Compared>;
  loads: TopicLoad[];
  kb_per_s: number;
  feasible: boolean;
}

export type Statement = SetStatement | KeepStatement | WithinStatement | RuleStatement | RawStatement;

/** An edit: write `replacement` in the place of a part of the text. */
export interface Substitute {
  kind: "substitute";
  offset: number;
  end_offset: number;
  replacement: string;
}

/** More findings on a draft; none for one with errors. */
export interface SurroundingsAnswer {
  findings: PlacedFinding[];
}

/** A draft; `recorded_topics` are those of the recording that goes with it. */
export interface SurroundingsRequest {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
  recorded_topics?: string[];
}

/** One text. */
export interface TextAnswer {
  text: string;
}

/** Why a topic is not shown as its rate says. */
export type ThinningDoubt = "changes are left out" | "no key frame found" | "no key frame for long";

/** A quality level; the value is its name in a rule file, the order that of rising quality. */
export const TIERS = ["Unacceptable", "Marginal", "Acceptable", "Desirable", "Competitive", "Excessive"] as const;
export type Tier = (typeof TIERS)[number];

/** The rate that the optimizer gives a level, named as in a rule file: `"Desirable"`. */
export interface TierRate {
  kind: "tier";
  value: Tier;
}

/** How a condition is taken over the time before; the value is its spelling. */
export type TimeWord = "For" | "Within";

/** `term For duration`: it held all that time; `term Within duration`: at some moment of it. */
export interface TimedCondition {
  kind: "timed";
  term: Condition;
  word: TimeWord;
  duration: DurationValue;
}

/** One arm's share of a topic: messages, bytes (as declared, where they are) and age. */
export interface TopicArm {
  messages: number;
  bytes: number;
  age: Age | null;
}

/** Share of the link that one topic takes in one situation; `rate_hz` is null for Full. */
export interface TopicLoad {
  topic: string;
  rate_hz: number | null;
  kb_per_s: number;
}

/**
 * How one topic does on a link.
 *
 * `age_ms` is how old its last message was when it arrived at the operator's end; `None` while unknown.
 */
export interface TopicOnLink {
  sent: number;
  replaced: number;
  overflowed: number;
  queued_bytes: number;
  losing: boolean;
  repaired: number;
  lost_replaced: number;
  lost_late: number;
  sent_bytes: number;
  repair_bytes: number;
  age_ms: number | null;
}

/**
 * Flow of one relayed topic in, and out on `output_topic`.
 *
 * `messages_out` includes `repeated`. `source_hz` and `mean_hz` are (n − 1) / (last − first) of what
 * came in and went out. `target_hz` is weighted by time, with Full as the source's rate;
 * `error_percent` is how far `mean_hz` lies above the lesser of target and `source_hz`, likewise
 * weighted, so it says little where the source's rate varies; it is `None` where bounds decide what
 * passes. Where messages name streams, such as child frames, `frames` counts them, the target is that of
 * each, and rates are means over them. `bounds` say how each bound of the receiver's picture was kept,
 * `unreadable` how many messages of a topic with bounds lack a value of one. `declared` says that sizes
 * are those that the bag declares. A number that the messages do not determine is `None`.
 */
export interface TopicOutcome {
  monitored_topic: string;
  in: number;
  out: number;
  repeated: number;
  source_hz: number | null;
  target_hz: number | null;
  mean_hz: number | null;
  error_percent: number | null;
  in_kb: number;
  out_kb: number;
  declared: boolean;
  frames: number | null;
  bounds?: Record<string, BoundRecord[]>;
}

/** Source of a topic's name; the value is its name in JSON, the order that of trust. */
export type TopicSource = "profile" | "robot" | "rules" | "example";

/**
 * One relayed topic.
 *
 * `reason`, `rule` and `line` are those of its planned rate. Rates are (n − 1) / (last − first) over
 * about ten seconds, those of the output since its target last changed, that of the source with what was
 * lost of it before it arrived here; `loss` is there while that is much. `target_hz` is infinite for
 * Full and 0 for Off, `expected_hz` the lesser of target and source, `error_percent` how far
 * `actual_hz` lies above it, and not `keeps_rate` that it is off by more than pacing explains.
 * `stamped_hz` is the rate by the messages' own header stamps and `delay_ms` how old the last one was
 * when it was relayed. `incompatible` are nodes that subscribe to the output with a QoS it cannot serve,
 * `problem` says why the topic cannot be relayed. `frames` counts the streams that the messages name,
 * such as child frames; rates are means over them then. `within` are the bounds of the receiver's picture
 * with their `bound_reasons`, as in the plan. A number that the messages do not determine is `None`.
 */
export interface TopicStatus {
  output: string;
  type: string | null;
  reason: Reason;
  rule: string | null;
  line: number | null;
  target_hz: number | null;
  source_hz: number | null;
  expected_hz: number | null;
  actual_hz: number | null;
  error_percent: number | null;
  keeps_rate: boolean;
  stamped_hz: number | null;
  delay_ms: number | null;
  in_kb_per_s: number;
  out_kb_per_s: number;
  publishers: number;
  subscribers: number;
  incompatible: string[];
  problem: string | null;
  silent: Silence | null;
  received: number;
  lost?: number;
  relayed: number;
  repeated: number;
  discarded: number;
  undecodable: number;
  dropped: number;
  frames?: number;
  loss?: LossBeforeRelay;
  doubt?: ThinningDoubt;
  link?: TopicOnLink;
  within?: Record<string, number>;
  bound_reasons?: Record<string, BoundReason>;
}

/** The headline of a try, or why the recording cannot be tried. */
export interface TriedRecording {
  headline: TryHeadline | null;
  problem: string;
  remedy: string;
}

/** Result of a try of the rule file `name`; see `LastTry`. */
export interface TriedRequest {
  name: string;
  bag: string;
  kb_per_s: number;
  percent: number;
}

/** Kleene's three values, ordered false < unknown < true: AND is the least, OR the greatest. */
export type Truth = "false" | "unknown" | "true";

/**
 * Result of a try of rules on a bag.
 *
 * Times are seconds since the bag's start. `…_bins` have one value for each `bin_s` seconds; the first
 * begins at `first_bin_s`, 0 or less. `decisions` are the first 2000 of `decision_count`; `path` is
 * `[seconds, x, y]` in metres where the bag has odometry. `incidents` are the first 200 that the rules
 * would have recorded, null where no rule records anything.
 */
export interface TryAnswer {
  duration_s: number;
  before_kb: number;
  after_kb: number;
  percent: number;
  worst_topic: WorstTopic | null;
  worst_field: WorstField | null;
  crossings: number;
  missed_crossings: number;
  notices: string[];
  bin_s: number;
  first_bin_s: number;
  decisions: TryDecision[];
  decision_count: number;
  topics: TryTopic[];
  path: [number, number, number][];
  blocks: BlockTurns[];
  loss: TryLoss;
  incidents: TryIncident[] | null;
}

/** How the operator saw a value cross the threshold of a check. */
export interface TryCrossing {
  check: string;
  crossings: number;
  received: Sightings;
}

/**
 * Another rate of a topic, or another deciding block, `t` seconds after the bag's start.
 *
 * `from_hz` and `to_hz` are null for Full; the first decision of a topic (`start`) has no `from_hz`.
 * `line` and `rule` are the deciding block's, null where none decided. `bounds` say which bound of
 * each property holds then, what decided it, and whether that is in doubt.
 */
export interface TryDecision {
  t: number;
  topic: string;
  start: boolean;
  from_hz: number | null;
  to_hz: number | null;
  reason: Reason;
  rule: string | null;
  line: number | null;
  bounds: string[];
}

/**
 * How far a field's last value received was from the robot's; the bins have the largest error.
 *
 * `sent` are the least and the greatest value sent, null where none was; `range` is what lies between
 * them, of an angle that goes round that of its course; `hold` is null where nothing of it was received.
 */
export interface TryFieldLoss {
  topic: string;
  field: string;
  unit: string;
  sent: [number, number] | null;
  range: number;
  hold: ErrorSize | null;
  error_bins: (number | null)[];
}

/**
 * Headline of a try on a bag; `percent` is how much less of the relayed topics was sent.
 *
 * The worst are null where nothing was lost. `missed_crossings` of the `crossings` of checks' thresholds
 * were not seen by the operator.
 */
export interface TryHeadline {
  duration_s: number;
  before_kb: number;
  after_kb: number;
  percent: number;
  worst_topic: WorstTopic | null;
  worst_field: WorstField | null;
  crossings: number;
  missed_crossings: number;
  notices: string[];
}

/** A topic of images as sent and as received. */
export interface TryImages {
  topic: string;
  sent: Frames;
  received: Frames;
}

/** Incident of a try, `t` seconds after the start: the `number`-th, 0 first. */
export interface TryIncident {
  number: number;
  t: number;
  record: IncidentRecord;
}

/** Loss of the operator: the numbers of `testudo bag loss`, without its third arm. */
export interface TryLoss {
  topics: TryTopicLoss[];
  fields: TryFieldLoss[];
  crossings: TryCrossing[];
  images: TryImages[];
}

/** Rules and a bag; `run` names the try in `Progress` messages of `/ws`. */
export interface TryRequest {
  text: string;
  name?: string;
  profile_text?: string | null;
  profile_name?: string;
  bag: string;
  run?: string;
}

/** One relayed topic of the bag; `*_hz_bins` are messages a second before and after, bin by bin. */
export interface TryTopic {
  topic: string;
  outcome: TopicOutcome;
  before_hz_bins: number[];
  after_hz_bins: number[];
}

/** How old a topic was; the bins have the greatest age in s. */
export interface TryTopicLoss {
  topic: string;
  sent: TopicArm;
  received: TopicArm;
  age_s_bins: (number | null)[];
}

/**
 * Content of an editor that is not saved.
 *
 * `content` is the text of a rule file, or the table of a profile as JSON; `beside` is what the editor
 * keeps with it. `base_hash` is the SHA-256 of the file that was changed, null where there was none.
 */
export interface Unsaved {
  content: string;
  beside: string;
  base_hash: string | null;
}

/** `Until op value` behind a check: what ends it. */
export interface UntilValue {
  op: Operator;
  value: Compared;
}

/** One version of the rule file `name`. */
export interface VersionRequest {
  name: string;
  id: string;
}

/** Versions of a rule file, the newest first, at most `most`, kept in `folder` of the project. */
export interface VersionsAnswer {
  versions: RuleVersion[];
  most: number;
  folder: string;
}

/**
 * Words that an editor suggests; `every_topic` are the properties of any topic.
 *
 * Checks alone can name `vitals`.
 */
export interface Vocabulary {
  topics: KnownTopic[];
  every_topic: Property[];
  vitals: KnownVitals[];
  allowed: Allowed;
}

/** The texts that an editor has open. */
export interface VocabularyRequest {
  text?: string | null;
  profile_text?: string | null;
}

/** The page asks for `Live` of one robot; null ends that. At most 20 a second. */
export interface Watch {
  kind: "watch";
  node: string | null;
  update_hz?: number;
}

/** `KeepWithin topic property bound`, as a default or in a rule. */
export interface WithinStatement {
  kind: "within";
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
  topic: string;
  property: string;
  bound: Bound;
}

/** The property with the largest error when its last value is held: its RMSE, `share` of its range. */
export interface WorstField {
  topic: string;
  field: string;
  unit: string;
  rmse: number;
  share: number;
}

/**
 * The topic that lost most: `received` of `sent` messages, or frames where it `is_image`.
 *
 * `longest_s` is the greatest age of its newest message at the operator, or the longest time without a
 * frame; `more_s` is how much longer that is than at the robot, null where nothing arrived.
 */
export interface WorstTopic {
  topic: string;
  sent: number;
  received: number;
  longest_s: number;
  more_s: number | null;
  is_image: boolean;
}

/** The robot's `file` holds the rules; what it held is beside it, in `previous_file`. */
export interface WriteAnswer {
  file: string;
  previous_file: string;
}

/** Two rules that clash with a zone in `common`; `message` and `hint` are the checker's. */
export interface ZoneClash {
  first: string;
  second: string;
  message: string;
  hint: string;
  common: ZoneRectangle[];
}

/** An upright rectangle in metres; `None` is a side that nothing bounds. */
export interface ZoneRectangle {
  min_x_m: number | null;
  max_x_m: number | null;
  min_y_m: number | null;
  max_y_m: number | null;
}

/** The zones of a draft; `label` is a name for a new zone that no rule has. */
export interface ZonesAnswer {
  rules: RuleZones[];
  clashes: ZoneClash[];
  label: string;
}

/** What each route is asked and answers. */
export interface Routes {
  "POST /api/background": { asked: BackgroundRequest; answered: Background };
  "POST /api/background/path": { asked: BagRequest; answered: DrivenPath };
  "GET /api/backgrounds": { asked: null; answered: BackgroundsAnswer };
  "POST /api/check/course": { asked: CheckCourseRequest; answered: CheckCourse };
  "POST /api/difference": { asked: DifferenceRequest; answered: DifferenceAnswer };
  "POST /api/document": { asked: Draft; answered: RuleDocument };
  "GET /api/draft": { asked: null; answered: DraftAnswer };
  "PUT /api/draft": { asked: DraftRequest; answered: DraftAnswer };
  "GET /api/drafts": { asked: null; answered: DraftsAnswer };
  "POST /api/edit": { asked: EditRequest; answered: EditAnswer };
  "GET /api/file": { asked: null; answered: FileAnswer };
  "PUT /api/file": { asked: SaveRequest; answered: SaveAnswer };
  "POST /api/file/copy": { asked: CopyRequest; answered: Project };
  "POST /api/file/delete": { asked: DeleteRequest; answered: Project };
  "POST /api/file/rename": { asked: RenameRequest; answered: Project };
  "GET /api/file/state": { asked: null; answered: FileOnDisk };
  "GET /api/file/summary": { asked: null; answered: FileSummary };
  "PUT /api/file/tried": { asked: TriedRequest; answered: LastTry };
  "POST /api/format": { asked: Draft; answered: TextAnswer };
  "POST /api/incident": { asked: OneIncidentRequest; answered: IncidentAnswer };
  "POST /api/incident/course": { asked: IncidentCourseRequest; answered: IncidentCourse };
  "POST /api/incident/delete": { asked: OneIncidentRequest; answered: IncidentsAnswer };
  "GET /api/incidents": { asked: null; answered: IncidentsAnswer };
  "POST /api/optimize": { asked: OptimizeRequest; answered: OptimizeAnswer };
  "POST /api/profile/accuracy": { asked: CurveRequest; answered: AccuracyNeeds };
  "POST /api/profile/check": { asked: ProfileWriteRequest; answered: ProfileCheckAnswer };
  "POST /api/profile/curve": { asked: CurveRequest; answered: Curve };
  "POST /api/profile/entry": { asked: ProfileEntryRequest; answered: TextAnswer };
  "POST /api/profile/for": { asked: ProfileForRequest; answered: ProfileForAnswer };
  "PUT /api/profile/for": { asked: ProfileChosenRequest; answered: ProfileForAnswer };
  "POST /api/profile/levels": { asked: LevelsRequest; answered: LevelsAnswer };
  "POST /api/profile/measure": { asked: MeasureRequest; answered: TextAnswer };
  "POST /api/profile/measure-live": { asked: MeasureLiveRequest; answered: TextAnswer };
  "POST /api/profile/parse": { asked: ProfileParseRequest; answered: ProfileTable };
  "GET /api/profile/presets": { asked: null; answered: Presets };
  "POST /api/profile/write": { asked: ProfileWriteRequest; answered: TextAnswer };
  "GET /api/project": { asked: null; answered: Project };
  "POST /api/push": { asked: PushRequest; answered: PushAnswer };
  "POST /api/push/confirm": { asked: PushedRequest; answered: ConfirmAnswer };
  "POST /api/push/lasting": { asked: RobotRequest; answered: LastingAnswer };
  "POST /api/push/preview": { asked: PushRequest; answered: PushPreview };
  "POST /api/push/write": { asked: PushedRequest; answered: WriteAnswer };
  "POST /api/recording": { asked: BagRequest; answered: RecordingAnswer };
  "PUT /api/recording": { asked: null; answered: ReceivedAnswer };
  "POST /api/recording/words": { asked: RecordedWordsRequest; answered: RecordedWords };
  "GET /api/robot-incidents": { asked: null; answered: RobotIncidentsAnswer };
  "POST /api/robot-incidents/cancel": { asked: RobotIncidentRequest; answered: FetchesAnswer };
  "POST /api/robot-incidents/fetch": { asked: RobotIncidentRequest; answered: FetchesAnswer };
  "GET /api/robot-incidents/fetches": { asked: null; answered: FetchesAnswer };
  "POST /api/robot/checks": { asked: RobotChecksRequest; answered: RobotChecksAnswer };
  "POST /api/robot/history": { asked: RobotRequest; answered: RobotHistoryAnswer };
  "POST /api/robot/remove": { asked: RobotRequest; answered: RobotRemoved };
  "POST /api/robot/start": { asked: RobotRequest; answered: RobotStartAnswer };
  "POST /api/surroundings": { asked: SurroundingsRequest; answered: SurroundingsAnswer };
  "POST /api/try": { asked: TryRequest; answered: TryAnswer };
  "POST /api/try/headline": { asked: TryRequest; answered: TriedRecording };
  "POST /api/try/keep": { asked: KeepRequest; answered: KeepsAnswer };
  "POST /api/try/keep/cancel": { asked: KeepEndRequest; answered: KeepsAnswer };
  "GET /api/try/keeps": { asked: null; answered: KeepsAnswer };
  "POST /api/version": { asked: VersionRequest; answered: TextAnswer };
  "GET /api/versions": { asked: null; answered: VersionsAnswer };
  "POST /api/vocabulary": { asked: VocabularyRequest; answered: Vocabulary };
  "POST /api/zones": { asked: Draft; answered: ZonesAnswer };
  "POST /api/zones/cover": { asked: CoverRequest; answered: CoverAnswer };
}
