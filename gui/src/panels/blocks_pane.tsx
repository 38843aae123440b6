// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, effect, type ReadonlySignal, untracked, useComputed, useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { FoundFile, RuleDocument, Statement, ZoneRectangle } from "../api/types";
import { toCondition } from "../blocks/model";
import type { DrawValues } from "../blocks/number_field";
import type { NewStatement } from "../blocks/rule_words";
import type { RuleWorkspace } from "../blocks/rule_workspace";
import { suggestionsOf } from "../blocks/suggestions";
import { zonesIn } from "../blocks/zones";
import { recipeRules } from "../recipes/recipes";
import { RecordingWords } from "../state/recording_words";
import type { RobotRules } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { statementsIn } from "../state/statements";
import type { Trial } from "../state/trial";
import { bagsIn, type FileTries, fileOf, recordingOf } from "../state/tries";
import { checkIn } from "../state/written_checks";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { useLoaded } from "../ui/later";
import { isNarrow, watchNarrow, watchSize, watchTheme } from "../ui/watch";
import { isLong, RuleOutline } from "./rule_outline";
import { RuleSearch } from "./rule_search";

interface PaneProps extends Omit<Shown, "isServerGone"> {
  /** The end of the bar. */
  budget: ComponentChildren;
  /** What stands beside the blocks. */
  beside: ComponentChildren;
  /** What unfolds the other panes. */
  children: ComponentChildren;
}

/** The rules as blocks, below a bar for all that is done with them. */
export function BlocksPane({ budget, beside, children, ...props }: PaneProps) {
  const { editor, robotRules } = props;
  const workspace = useRef<RuleWorkspace | null>(null);
  const isBelow = useSignal(isNarrow());
  const hasOutline = useSignal(!isBelow.value);
  const isLoaded = useSignal(false);
  useEffect(
    () =>
      watchNarrow(() => {
        isBelow.value = isNarrow();
        hasOutline.value = !isBelow.value;
      }),
    [],
  );
  // Each key changes what these are made of, and seldom one of them.
  const isBehind = useComputed(
    () => !editor.document.value.parses && editor.shown.value?.text !== editor.text.value,
  ).value;
  const isReadOnly = useComputed(() => editor.isBroken.value || editor.shown.value === null || !isLoaded.value).value;
  const errors = useComputed(() => editor.errors.value.length).value;
  const isMany = useComputed(() => isLong(editor)).value;
  const add = (kind: NewStatement) => void workspace.current?.addStatement(kind);
  const go = (index: number) => void workspace.current?.unfold(index);
  return (
    <>
      <div class="rules-top">
        <div class="pane-bar rules-bar">
          <NeedsServer>
            <Button label="New rate" class="small" disabled={isReadOnly} onClick={() => add("rate")} />
            <Button label="New rule" class="small" disabled={isReadOnly} onClick={() => add("rule")} />
          </NeedsServer>
          <RuleSearch {...{ editor, robotRules }} onGo={go} onAdd={isReadOnly ? null : add} />
          {isMany && (
            <Button
              label="Outline"
              class="small"
              aria-expanded={hasOutline.value}
              onClick={() => (hasOutline.value = !hasOutline.value)}
            />
          )}
          {isBehind && (
            <p class="pane-note" role="status">
              The text has {errors === 1 ? "an error" : `${errors} errors`}: the blocks show how it was before.
            </p>
          )}
          {budget}
        </div>
        {children}
      </div>
      <div class="split">
        <section class={isBehind ? "pane blocks behind" : "pane blocks"} aria-label="Blocks">
          <h2 class="visually-hidden">Blocks</h2>
          <div class="blocks-body">
            {isMany && hasOutline.value && (
              <RuleOutline
                {...{ editor, robotRules }}
                onGo={(index) => {
                  // On a narrow page it covers the blocks.
                  if (isBelow.value) hasOutline.value = false;
                  go(index);
                }}
                onFoldAll={(isFolded) => void workspace.current?.foldAll(isFolded)}
              />
            )}
            <BlocksHost
              {...props}
              // What is beside the blocks of a wide page is above those of a narrow one, from when they are made.
              key={isBelow.value ? "narrow" : "wide"}
              opened={(opened) => {
                workspace.current = opened;
                isLoaded.value = opened !== null;
              }}
            />
          </div>
          {editor.isEmpty.value && (
            <p class="empty-hint">
              Begin with <strong>New rate</strong>: how often a topic is sent while no rule decides. Then add a{" "}
              <strong>New rule</strong>: when that changes. Recipes are in the list of blocks.
            </p>
          )}
        </section>
        {beside}
      </div>
    </>
  );
}

interface HostProps extends Omit<Shown, "isServerGone"> {
  /** Null where it is gone again. */
  opened: (workspace: RuleWorkspace | null) => void;
}

/** Where Blockly draws. */
function BlocksHost({ opened, ...props }: HostProps) {
  const host = useRef<HTMLDivElement>(null);
  const { isServerGone } = useRobot();
  // The text can be read and changed before the blocks are there, which take longer.
  const loaded = useLoaded(() => import("../blocks/rule_workspace"));
  useEffect(() => {
    const here = host.current;
    if (!here || loaded === null) return;
    const { workspace, close } = openWorkspace(loaded.RuleWorkspace, here, { ...props, isServerGone });
    opened(workspace);
    return () => {
      opened(null);
      close();
    };
  }, [loaded]);
  return <div class="blocks-host" ref={host} />;
}

interface Shown {
  editor: RuleEditor;
  robotRules: RobotRules;
  tried: ReadonlySignal<Trial | null>;
  /** The recording of the rules. */
  recording: () => FoundFile | undefined;
  /** Somebody wants to draw a zone of a rule on the map. */
  onDrawZone: (rule: string, rectangle: ZoneRectangle) => void;
  /** Whether the rules are to be seen as text, too. */
  hasText: () => boolean;
  isServerGone: ReadonlySignal<boolean>;
}

function openWorkspace(
  Workspace: typeof RuleWorkspace,
  host: HTMLElement,
  { editor, robotRules, tried, recording, onDrawZone, hasText, isServerGone }: Shown,
): { workspace: RuleWorkspace; close: () => void } {
  const show = () => {
    const shown = editor.shown.peek();
    if (shown) workspace.show(shown.document, editor.shownSections.peek());
  };
  const recorded = new RecordingWords(editor.api, recording);
  const known = { words: editor.words, profile: editor.profile, live: robotRules.live, tried };
  const zones = computed(() => zonesIn(statementsIn(editor.shown.value?.document ?? { collections: [] })));
  const workspace = new Workspace(host, {
    recipes: () => editor.attempt(() => recipeRules(editor.api)),
    menus: {
      undo: () => editor.undo(),
      redo: () => editor.redo(),
      canUndo: () => editor.history.canUndo.peek(),
      canRedo: () => editor.history.canRedo.peek(),
    },
    suggestions: {
      ...suggestionsOf({ ...known, recorded }),
      zones: () => zones.peek(),
      drawValues: valuesOfRecording(editor, recording),
    },
    changed: (editsOf, refused, isPlaceholder) => {
      const edits = (document: RuleDocument) => {
        if (document === editor.shown.peek()?.document) workspace.catchUp(document);
        return editsOf(document);
      };
      return editor.edit(edits, refused, isPlaceholder);
    },
    lost: (lost) => (editor.lost.value = { name: editor.name, ...lost }),
    tell: (message) => (editor.message.value = message),
    drawZone: onDrawZone,
    mend: (finding) => void editor.fix(finding),
    leftOut: (count) => (editor.blocksLeftOut = count),
    ahead: (isAhead) => editor.setAhead(workspace, isAhead),
    showAgain: show,
    folds: editor.folds,
    selected: (id) => {
      const statement = editor.statement(id);
      if (statement) editor.point(statement, "blocks");
    },
  });
  editor.handOver = (withOpenField) => workspace.handOver(withOpenField);
  const stops = [
    effect(() => {
      void editor.shown.value;
      show();
    }),
    effect(() => workspace.mark(editor.findings.value)),
    effect(() => workspace.showLive(robotRules.states.value, robotRules.differing.value)),
    effect(() => workspace.setReadOnly(editor.isBroken.value || editor.shown.value === null || isServerGone.value)),
    effect(() => {
      const spot = editor.spot.value;
      const isElsewhere = spot !== null && spot.from !== "blocks";
      workspace.reveal(isElsewhere ? (editor.statementAt(spot.offset)?.id ?? null) : null);
    }),
    effect(() => {
      const spot = editor.spot.value;
      const at = untracked(() => editor.statements.value.indexOf(editor.statementAt(spot?.offset ?? -1) as Statement));
      if (spot?.from === "findings" && at >= 0 && !editor.isBroken.peek() && !hasText()) void workspace.unfold(at);
    }),
    watchSize(host, () => workspace.resize()),
    watchTheme(() => workspace.applyTheme()),
  ];
  const close = () => {
    for (const stop of stops) stop();
    workspace.dispose();
    editor.blocksLeftOut = 0;
    editor.handOver = null;
  };
  return { workspace, close };
}

/** Finds the recording of rules; none in a project without recordings. */
export function recordingOfRules(
  editor: RuleEditor,
  tries: FileTries,
  files: () => readonly FoundFile[],
): () => FoundFile | undefined {
  return () => fileOf(recordingOf(bagsIn(files()), tries, editor.rules, editor.map.peek().bag), files());
}

/** Draws the values of a check in the recording of its rules. */
function valuesOfRecording(editor: RuleEditor, recordingOf: () => FoundFile | undefined): DrawValues {
  return (host, block, threshold) => {
    const recording = recordingOf();
    const condition = toCondition(block);
    const check = condition && checkIn(condition);
    if (recording === undefined || !condition || !check) return null;
    const asked = { bag: recording.name, check, condition, profileText: editor.profile.peek()?.text ?? null };
    let isLeft = false;
    let close: (() => void) | null = null;
    void import("../try/check_courses").then(({ drawPicked }) => {
      if (!isLeft) close = drawPicked(host, { api: editor.api, asked, sizeBytes: recording.size_bytes, threshold });
    });
    return () => {
      isLeft = true;
      close?.();
    };
  };
}
