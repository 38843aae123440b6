// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, effect, type ReadonlySignal, signal, untracked } from "@preact/signals";
import { type Api, ApiError } from "../api/client";
import type { Live, PushPreview } from "../api/types";
import { type RuleState, ruleStates } from "../blocks/live_states";
import type { RobotLink } from "./robot_link";
import type { RuleEditor } from "./rule_editor";

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
  /** What the robot says of each rule now, by statement id; empty unless it follows these very rules. */
  readonly states = computed(() => {
    const live = this.link.calm.value;
    if (this.comparison.value.kind !== "same" || live === null || this.editor.isBroken.value) return NONE;
    return ruleStates(this.editor.document.value, live);
  });
  /** What the chosen robot does now. */
  readonly live: ReadonlySignal<Live | null>;
  private timer: number | undefined;
  private asked = 0;

  constructor(
    private readonly api: Api,
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
      const preview = await this.api.ask("POST /api/push/preview", { ...this.editor.rules, node });
      tell({ kind: preview.same ? "same" : "other", preview });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      tell({ kind: "unclear", why: error.message });
      // The robot, or the server, may answer yet.
      if (asked === this.asked && (error.status === 0 || error.status >= 500)) this.compareSoon(node, AGAIN_AFTER_MS);
    }
  }
}
