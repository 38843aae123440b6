// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, effect, type ReadonlySignal, signal, untracked } from "@preact/signals";
import { ApiError, type Rules } from "../api/client";
import type {
  LastingAnswer,
  Live,
  Problem,
  PushPreview,
  RobotSummary,
  RuleDocument,
  RulesOrigin,
  Statement,
} from "../api/types";
import { type RuleState, ruleStates } from "../blocks/live_states";
import type { RobotLink } from "./robot_link";
import type { RuleEditor } from "./rule_editor";
import { statementsIn } from "./statements";

const COMPARE_AFTER_MS = 300;
const AGAIN_AFTER_MS = 5000;
const NONE: ReadonlyMap<string, RuleState> = new Map();

/** How the open rules stand to those on the robot. */
type Comparison =
  | { kind: "none" }
  | { kind: "same"; preview: PushPreview }
  | { kind: "other"; preview: PushPreview }
  | { kind: "unclear"; why: string };

/** The open rules beside those that the chosen robot follows. */
export class RobotRules {
  readonly comparison = signal<Comparison>({ kind: "none" });
  /** The keys of the rules when they were compared last with what the robot follows; false for those that it has otherwise. */
  private readonly known = signal<ReadonlyMap<string, boolean>>(new Map());
  /** The rules that the robot has otherwise or not at all, by statement id. */
  readonly differing = computed(() => {
    const known = this.known.value;
    const rules = this.editor.isBroken.value ? [] : rulesIn(this.editor.document.value);
    const others = known.size === 0 ? [] : rules.filter(({ key }) => !known.get(key ?? ""));
    return new Set(others.map(({ id = "" }) => id));
  });
  /** What the robot says of each rule now, by statement id: of those that it follows as they are. */
  readonly states = computed(() => {
    const [live, differing] = [this.link.calm.value, this.differing.value];
    if (this.known.value.size === 0 || live === null || this.editor.isBroken.value) return NONE;
    const all = ruleStates(this.editor.document.value, live);
    // Unnamed rules are told apart by their order, which another rule may have changed.
    const isUnsure = (id: string) => differing.size > 0 && isUnnamed(this.editor.statement(id));
    return new Map([...all].filter(([id]) => !differing.has(id) && !isUnsure(id)));
  });
  /** What the chosen robot does now. */
  readonly live: ReadonlySignal<Live | null>;
  private timer: number | undefined;
  private asked = 0;

  constructor(
    private readonly editor: RuleEditor,
    private readonly link: RobotLink,
  ) {
    this.live = link.calm;
  }

  /** Compares whenever either side changes, until the returned function is called. */
  follow(): () => void {
    const stopWatching = this.link.watch();
    const hash = computed(() => this.link.robot.value?.rules.sha256);
    // A silent robot is not asked anything.
    const heard = computed(() => (this.link.connection.value.kind === "connected" ? this.link.node.value : null));
    // Before that there is no text, or no profile that says what its levels are.
    const ready = computed(() => (this.editor.isChecked.value ? heard.value : null));
    const forget = effect(() => {
      void [hash.value, heard.value];
      this.known.value = new Map();
    });
    const stop = effect(() => {
      void [this.editor.text.value, this.editor.profile.value, hash.value];
      const node = ready.value;
      this.asked++;
      window.clearTimeout(this.timer);
      if (this.comparison.peek().kind !== "none") this.comparison.value = { kind: "none" };
      if (node !== null) this.compareSoon(node, COMPARE_AFTER_MS);
    });
    // A robot that is heard brings its topics to suggest.
    const stopReading = effect(() => {
      if (heard.value !== null) untracked(() => void this.editor.check());
    });
    return () => {
      forget();
      stop();
      stopReading();
      stopWatching();
      window.clearTimeout(this.timer);
    };
  }

  private compareSoon(node: string, afterMs: number): void {
    this.timer = window.setTimeout(() => void this.compare(node), afterMs);
  }

  private async compare(node: string): Promise<void> {
    const asked = this.asked;
    const tell = (comparison: Comparison) => {
      if (asked === this.asked) this.comparison.value = comparison;
    };
    try {
      if (!(await this.editor.isSound())) return tell({ kind: "unclear", why: "The text has errors." });
      const rules = rulesIn(this.editor.document.peek());
      const preview = await this.editor.api.ask("POST /api/push/preview", { ...this.editor.rules, node });
      if (asked === this.asked)
        this.known.value = new Map(rules.map(({ key = "" }, at) => [key, !preview.differing_rules.includes(at)]));
      tell({ kind: preview.same ? "same" : "other", preview });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      tell({ kind: "unclear", why: error.message });
      // The robot, or the server, may answer yet.
      if (asked === this.asked && (error.status === 0 || error.status >= 500)) this.compareSoon(node, AGAIN_AFTER_MS);
    }
  }
}

function rulesIn(document: RuleDocument): Statement[] {
  return statementsIn(document).filter(({ kind }) => kind === "rule");
}

function isUnnamed(statement: Statement | undefined): boolean {
  return statement?.kind === "rule" && statement.name === null;
}

/** Where rules are on their way to a robot. */
export type Stage =
  | { kind: "idle" }
  | { kind: "asking"; node: string }
  | { kind: "asked"; node: string; preview: PushPreview; rules: Rules }
  | { kind: "sending"; node: string }
  | { kind: "trying"; node: string; hash: string; withinS: number; isSeen: boolean; isLetGo: boolean }
  | { kind: "kept"; node: string; hash: string; isSeen: boolean; lasting: LastingAnswer | null }
  | { kind: "written"; node: string; file: string; previousFile: string }
  | { kind: "replaced"; node: string; by: RulesOrigin }
  | { kind: "gone"; node: string }
  | { kind: "refused"; outcome: string; problem: Problem };

const UNCHANGED = "Nothing was changed on the robot.";

/** Sends the open rules to a robot: compared, tried there for some seconds, and kept only when somebody says so. */
export class RulePush {
  readonly stage = signal<Stage>({ kind: "idle" });
  /** For how long the tried rules still hold, in whole seconds. */
  readonly leftS = computed(() => {
    const stage = this.stage.value;
    if (stage.kind !== "trying") return 0;
    const live = stage.node === this.link.node.value ? this.link.live.value?.status : undefined;
    const waitsS = (live ?? this.robotAt(stage.node))?.rules.waits_s;
    return Math.max(0, Math.ceil(waitsS ?? stage.withinS));
  });

  /** Whether the robot that the rules went to sends a status now; otherwise it is unknown what it follows. */
  readonly isHeard = computed(() => {
    const stage = this.stage.value;
    if (!("node" in stage)) return false;
    const isChosen = stage.node === this.link.node.value;
    return isChosen ? this.link.connection.value.kind === "connected" : (this.robotAt(stage.node)?.is_heard ?? false);
  });

  constructor(
    private readonly editor: RuleEditor,
    private readonly link: RobotLink,
  ) {}

  /** Follows what the robot does with the rules, until the returned function is called. */
  follow(): () => void {
    return effect(() => {
      const stage = this.stage.value;
      if (stage.kind !== "trying" && stage.kind !== "kept") return;
      const robot = this.robotAt(stage.node);
      if (robot !== undefined) this.stage.value = seen(stage, robot);
    });
  }

  /** Asks what would change on the robot; not while one has rules that somebody can still keep. */
  async ask(): Promise<void> {
    if (this.isToBeKept()) return;
    const node = this.link.node.peek();
    const { kind, why } = this.link.connection.peek();
    if (node === null || kind !== "connected") return this.refuse({ message: why });
    this.stage.value = { kind: "asking", node };
    if (!(await this.editor.isSound())) {
      const findings = this.editor.errors.peek();
      return this.refuse({ message: "Rules with errors are not sent.", findings });
    }
    await this.guarded(UNCHANGED, UNCHANGED, async () => {
      const { rules } = this.editor;
      const preview = await this.editor.api.ask("POST /api/push/preview", { ...rules, node });
      this.stage.value = { kind: "asked", node, preview, rules };
    });
  }

  /** Sends what was compared. */
  async send(): Promise<void> {
    const stage = this.stage.peek();
    if (stage.kind !== "asked") return;
    const { node, rules } = stage;
    this.stage.value = { kind: "sending", node };
    const unknown =
      "It is not known whether the robot received the rules. If it did, it reverts them unless they are kept.";
    await this.guarded(unknown, UNCHANGED, async () => {
      const staged = await this.editor.api.push(rules, node);
      const withinS = staged.confirm_within_s;
      this.stage.value =
        staged.state === "same"
          ? { kind: "kept", node, hash: staged.hash, isSeen: false, lasting: null }
          : { kind: "trying", node, hash: staged.hash, withinS, isSeen: false, isLetGo: false };
    });
  }

  /** Lets the robot follow the tried rules for good. */
  async keep(): Promise<void> {
    const stage = this.stage.peek();
    if (stage.kind !== "trying") return;
    const unknown = `It is not known whether the rules were kept. If not, the robot reverts them within ${stage.withinS} s.`;
    await this.guarded(unknown, "The rules were not kept, and the robot reverts them.", async () => {
      await this.editor.api.ask("POST /api/push/confirm", { node: stage.node, hash: stage.hash });
      const { node, hash, isSeen } = stage;
      this.stage.value = { kind: "kept", node, hash, isSeen, lasting: null };
    });
  }

  /** Asks how long the kept rules last; where that is not known, nothing is said of it. */
  async askLasting(): Promise<void> {
    const { node } = { node: "", ...this.stage.peek() };
    try {
      const lasting = await this.editor.api.ask("POST /api/push/lasting", { node });
      const stage = this.stage.peek();
      if (stage.kind === "kept" && stage.node === node) this.stage.value = { ...stage, lasting };
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
    }
  }

  /** Has the robot write the kept rules to its file. */
  async write(): Promise<void> {
    const stage = this.stage.peek();
    if (stage.kind !== "kept") return;
    const unknown = "It is not known whether the rules were written to the robot's file.";
    await this.guarded(unknown, "The rules are in force, and were not written to the robot's file.", async () => {
      const { file, previous_file: previousFile } = await this.editor.api.ask("POST /api/push/write", {
        node: stage.node,
        hash: stage.hash,
      });
      this.stage.value = { kind: "written", node: stage.node, file, previousFile };
    });
  }

  /** Leaves the tried rules unconfirmed, so that the robot goes back by itself. */
  letGo(): void {
    const stage = this.stage.peek();
    if (stage.kind === "trying") this.stage.value = { ...stage, isLetGo: true };
  }

  close(): void {
    this.stage.value = { kind: "idle" };
  }

  private isToBeKept(): boolean {
    const stage = this.stage.peek();
    return stage.kind === "sending" || (stage.kind === "trying" && !stage.isLetGo && this.isHeard.peek());
  }

  private robotAt(node: string): RobotSummary | undefined {
    return this.link.robots.value?.robots.find((each) => each.node === node);
  }

  private refuse(problem: Partial<Problem> & { message: string }, outcome = UNCHANGED): void {
    this.stage.value = { kind: "refused", outcome, problem: { place: "", remedy: "", findings: [], ...problem } };
  }

  /** Does `work`. A refusal has the outcome `refused`; where no answer came, it is `unknown`. */
  private async guarded(unknown: string, refused: string, work: () => Promise<void>): Promise<void> {
    try {
      await work();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      const isAnswered = error.status >= 400 && error.status < 500;
      this.refuse(error.problem, isAnswered ? refused : unknown);
    }
  }
}

/** The stage after a status of `robot`. Until one has the hash of the sent rules, it may be from before them. */
function seen(stage: Extract<Stage, { kind: "trying" | "kept" }>, robot: RobotSummary): Stage {
  const { node, hash, isSeen } = stage;
  const { sha256, origin } = robot.rules;
  const isThere = sha256 === hash;
  if (stage.kind === "kept") {
    if (!isThere && isSeen) return { kind: "replaced", node, by: origin };
    return isThere && !isSeen ? { ...stage, isSeen: true } : stage;
  }
  if (!isThere) return isSeen ? { kind: "gone", node } : stage;
  if (isSeen && origin !== "waiting") return { kind: "kept", node, hash, isSeen, lasting: null };
  return !isSeen && origin === "waiting" ? { ...stage, isSeen: true } : stage;
}
