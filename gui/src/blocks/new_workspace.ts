// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import * as english from "blockly/msg/en";
import type { Condition, RuleStatement, SetStatement, Statement } from "../api/types";
import type { PickerChoice } from "../ui/picker";
import { isForFingers, isNarrow, styleOf } from "../ui/watch";
import { ACTION_TYPES } from "./action_model";
import { type BlockButtons, defineBlocks } from "./block_types";
import type { Suggestions } from "./fields";
import { rendererName } from "./finding_marks";
import { type MenuPage, useOwnMenus } from "./menus";
import { type RuleBlock, stacked, toBlock } from "./model";
import { isTyped, openField } from "./open_field";
import { INSIDE } from "./zones";

const SCALE = 0.72;
const SCALE_FOR_FINGERS = 0.95;

/** A workspace of Blockly that knows the blocks of rules; `ofPage` is what it cannot do alone. */
export function newWorkspace(
  host: HTMLElement,
  suggestions: Suggestions,
  recipes: () => Promise<readonly Statement[] | null>,
  ofPage: Pick<BlockButtons, "act" | "toggleFold" | "drawZone">,
  page: MenuPage,
): Blockly.WorkspaceSvg {
  Blockly.setLocale(english as unknown as Record<string, string>);
  const buttons: BlockButtons = {
    addCheck: (block) => addCheck(block, suggestions),
    addRate: (block, input) => addRate(block, input, suggestions.topics()),
    addBound: (block, input) => addBound(block, input, suggestions),
    addRecord,
    addAct,
    toggleElse: (block) => toggleElse(block, suggestions.topics()),
    remove: (block) => block.checkAndDelete(),
    ...ofPage,
  };
  defineBlocks(suggestions, buttons);
  addAnotherOnShiftEnter(buttons, () => page.addStatement("rate"));
  const isBelow = isNarrow();
  // Else each block measures its texts anew, for which the browser computes styles each time.
  Blockly.utils.dom.startTextWidthCache();
  const workspace = silently(() =>
    Blockly.inject(host, {
      // A question of the browser's own would have no list to pick from.
      modalInputs: false,
      renderer: rendererName(),
      theme: blocklyTheme(host),
      toolbox: toolbox(),
      // Beside the blocks it would leave them no room.
      horizontalLayout: isBelow,
      media: "./media/",
      trashcan: false,
      // A rule is switched off in the text.
      disable: false,
      sounds: false,
      zoom: {
        controls: !isBelow,
        wheel: false,
        pinch: true,
        startScale: isForFingers() ? SCALE_FOR_FINGERS : SCALE,
        minScale: 0.3,
        maxScale: 2,
      },
      move: { scrollbars: true, drag: true, wheel: true },
    }),
  );
  // What was copied in rules that were open before is pasted here.
  if (Blockly.clipboard.getLastCopiedData()) Blockly.clipboard.setLastCopiedWorkspace(workspace);
  offerRecipes(workspace, recipes);
  useOwnMenus(workspace, buttons, page);
  useOwnKeys(host);
  scrollByFinger(host);
  // The text keeps what is undone.
  workspace.MAX_UNDO = 0;
  keepFocus(host);
  return workspace;
}

/** Lets nobody edit blocks, or everybody; Blockly says of a field which it is only while it draws the block. */
export function setReadOnly(workspace: Blockly.WorkspaceSvg, readOnly: boolean): void {
  if (readOnly === workspace.isReadOnly()) return;
  workspace.setIsReadOnly(readOnly);
  for (const field of workspace.getAllBlocks(false).flatMap((block) => [...block.getFields()])) {
    field.updateEditable();
    // It would call a plain word a button.
    if (!(field instanceof Blockly.FieldLabel)) field.recomputeAriaContext();
  }
}

/** Blockly opens an audio context for each workspace, even for one without sounds. */
function silently<T>(work: () => T): T {
  const { AudioContext } = window;
  Object.assign(window, { AudioContext: undefined });
  try {
    return work();
  } finally {
    Object.assign(window, { AudioContext });
  }
}

/**
 * Keeps the focus where two keys lead within a frame: Blockly 13.3 brings a focused block to the front a frame later by
 * moving those behind it, which takes the focus from one that got it meanwhile.
 */
function keepFocus(host: HTMLElement): void {
  let focused: EventTarget | null = null;
  host.addEventListener("focusin", ({ target }) => {
    focused = target;
    requestAnimationFrame(() => {
      const isLost = document.activeElement === document.body;
      if (isLost && focused instanceof SVGElement && focused.isConnected) focused.focus({ preventScroll: true });
    });
  });
}

/**
 * Adds a check below the last one: the other bound of it, as most zones have two; where it has both already, one of
 * the topic's next property.
 */
function addCheck(block: Blockly.BlockSvg, suggest: Suggestions): void {
  const input = block.getInput("IF") ? "IF" : "TERMS";
  const last = lastIn(block, input);
  const model = last?.type === "adirf_check" ? last : null;
  const topic = String(model?.getFieldValue("TOPIC") ?? "/odom");
  const property = String(model?.getFieldValue("PROPERTY") ?? "pose_x");
  const bounded = model?.getPreviousBlock();
  const hasBoth = bounded?.type === "adirf_check" && bounded.getFieldValue("PROPERTY") === property;
  const isBelow = model !== null && !hasBoth && model.getFieldValue("OP") === ">";
  const fields = {
    TOPIC: topic,
    PROPERTY: hasBoth ? after(property, suggest.properties(topic)) : property,
    OP: isBelow ? "<" : ">",
    VALUE: 0,
  };
  append(block, input, "adirf_check", fields, "VALUE");
}

/** The word behind another one; that itself where there is none. */
function after(word: string, all: readonly PickerChoice[]): string {
  const at = all.findIndex((each) => each.word === word);
  return (at < 0 ? undefined : all[at + 1]?.word) ?? word;
}

/** Adds a rate for a topic that the part does not set yet. */
function addRate(block: Blockly.BlockSvg, input: string, topics: readonly string[]): void {
  const sets = stacked(block, input).filter(({ type }) => type === "adirf_set");
  const topic = topics.find((each) => sets.every((set) => set.getFieldValue("TOPIC") !== each)) ?? "/topic";
  const rate = sets.at(-1)?.getFieldValue("RATE") ?? "10";
  append(block, input, "adirf_set", { TOPIC: topic, RATE: rate }, "TOPIC");
}

/** Adds a bound for a property that the part does not bound yet, of a topic that has some for it first. */
function addBound(block: Blockly.BlockSvg, input: string, suggest: Suggestions): void {
  const bounds = stacked(block, input).filter(({ type }) => type === "adirf_within");
  const isTaken = (topic: string, property: string) =>
    bounds.some((each) => each.getFieldValue("TOPIC") === topic && each.getFieldValue("PROPERTY") === property);
  const all = suggest.topics().flatMap((topic) => suggest.bounds(topic).map(({ word }) => ({ topic, property: word })));
  const free = all.filter(({ topic, property }) => !isTaken(topic, property));
  const { topic, property } = free.find((each) => each.property === "position") ??
    free[0] ?? { topic: "/odom", property: "position" };
  append(block, input, "adirf_within", { TOPIC: topic, PROPERTY: property }, "TOPIC");
}

function addRecord(block: Blockly.BlockSvg, input: string): void {
  append(block, input, "adirf_record", {}, "NAME");
}

function addAct(block: Blockly.BlockSvg, input: string, type: string): void {
  append(block, input, type, {}, ACT_FIELDS[type] ?? "TEXT");
}

/** The field that is opened of a new block of what a rule does. */
const ACT_FIELDS: Readonly<Record<string, string>> = { adirf_parameter: "NODE", adirf_call: "SERVICE" };

function toggleElse(block: Blockly.BlockSvg, topics: readonly string[]): void {
  Blockly.Events.setGroup(true);
  const rule = block as RuleBlock;
  const shown = rule.getInput("ELSE") !== null;
  if (shown) rule.getInputTargetBlock("ELSE")?.dispose(false);
  rule.setElse(!shown);
  if (!shown) addRate(rule, "ELSE", topics);
  else Blockly.Events.fire(new Blockly.Events.BlockChange(block, "mutation", null, null, ""));
  Blockly.Events.setGroup(false);
}

function lastIn(block: Blockly.Block, input: string): Blockly.Block | null {
  return block.getInputTargetBlock(input)?.lastConnectionInStack(true)?.getSourceBlock() ?? null;
}

/** Puts a new block below the last one of a part, and opens its field `first`. */
function append(
  block: Blockly.BlockSvg,
  input: string,
  type: string,
  fields: Record<string, unknown>,
  first: string,
): void {
  const added = Blockly.serialization.blocks.append({ type, fields }, block.workspace) as Blockly.BlockSvg;
  const connection = lastIn(block, input)?.nextConnection ?? block.getInput(input)?.connection;
  if (connection && added.previousConnection) connection.connect(added.previousConnection);
  openField(added.getField(first));
}

const { registry } = Blockly.ShortcutRegistry;
const NAME = "add_another";

/** Lets Shift+Enter add one more of what has the focus, below it: a check, a rate, a bound, a recording or a default. */
function addAnotherOnShiftEnter(buttons: BlockButtons, addDefault: () => void): void {
  const { KeyCodes } = Blockly.utils;
  const callback = () => {
    const node = Blockly.getFocusManager().getFocusedNode();
    const block = node instanceof Blockly.Field ? node.getSourceBlock() : node;
    if (!(block instanceof Blockly.BlockSvg)) return false;
    const parent = block.getSurroundParent();
    if (parent === null && block.type !== "adirf_set") return false;
    Blockly.WidgetDiv.hideIfOwner(node);
    if (parent === null) addDefault();
    else addBeside(block, parent, buttons);
    return true;
  };
  const keyCodes = [registry.createSerializedKey(KeyCodes.ENTER, [KeyCodes.SHIFT])];
  // The page opened other rules before, whose buttons are gone.
  if (NAME in registry.getRegistry()) registry.unregister(NAME);
  registry.register({ name: NAME, callback, keyCodes, preconditionFn: (space) => !space.isReadOnly() });
}

function addBeside(block: Blockly.BlockSvg, parent: Blockly.BlockSvg, buttons: BlockButtons): void {
  const holds = (name: string) => parent.getInputTargetBlock(name)?.getDescendants(false).includes(block);
  const part = holds("ELSE") ? "ELSE" : "THEN";
  if (block.type === "adirf_set") buttons.addRate(parent, part);
  else if (block.type === "adirf_within") buttons.addBound(parent, part);
  else if (block.type === "adirf_record") buttons.addRecord(parent, part);
  else if (ACTION_TYPES.has(block.type)) buttons.addAct(parent, part, block.type);
  else buttons.addCheck(parent);
}

/** What the column of blocks and our own buttons do. */
const SUPERFLUOUS = ["cleanup", "duplicate"];

/** Lets a letter on a field that has the focus open it, as in a table: it is no shortcut there. */
function useOwnKeys(host: HTMLElement): void {
  for (const name of SUPERFLUOUS) if (name in registry.getRegistry()) registry.unregister(name);
  const open = (event: KeyboardEvent) => {
    const field = Blockly.getFocusManager().getFocusedNode();
    const isLetter = event.key.length === 1 && event.key !== " " && !event.ctrlKey && !event.metaKey && !event.altKey;
    if (!isLetter || !isTyped(field) || Blockly.WidgetDiv.isVisible()) return;
    const block = field.getSourceBlock();
    if (!(block instanceof Blockly.BlockSvg) || block.workspace.isReadOnly() || !block.isEditable()) return;
    event.stopPropagation();
    // The letter itself goes into the field, in the place of what is marked there.
    openField(field);
  };
  host.addEventListener("keydown", open, { capture: true });
}

/** Lets a finger that swipes over blocks scroll them, as it does elsewhere; it drags the block that it tapped before. */
function scrollByFinger(host: HTMLElement): void {
  let down: PointerEvent | null = null;
  let tapped: object | null = null;
  const lift = (event: PointerEvent) => {
    if (event.pointerId !== down?.pointerId) return;
    const isTap = Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) <= Blockly.config.dragRadius;
    const touched = Blockly.getSelected();
    // What was dragged can be dragged on.
    if (isTap || touched !== tapped) tapped = isTap ? touched : null;
    down = null;
  };
  const press = (event: PointerEvent) => {
    down = event.pointerType === "touch" ? event : null;
  };
  host.addEventListener("pointerdown", press, { capture: true });
  host.addEventListener("pointerup", lift, { capture: true });
  host.addEventListener("pointercancel", lift, { capture: true });
  for (const definition of Object.values(Blockly.Blocks)) {
    Object.assign(definition, {
      isMovable(this: Blockly.BlockSvg) {
        const isSwiped = down !== null && this !== tapped && !this.isInFlyout;
        return !isSwiped && Blockly.BlockSvg.prototype.isMovable.call(this);
      },
    });
  }
}

/** At the scale of blocks it is 13 px. */
const FONT_PT = 13.6;
const BLOCK_STYLES = {
  rate: { colourPrimary: "#2b6cb0", colourSecondary: "#dbe9f8", colourTertiary: "#1e4f85" },
  floor: { colourPrimary: "#6b4fa3", colourSecondary: "#e7def7", colourTertiary: "#4c3679" },
  rule: { colourPrimary: "#a2590c", colourSecondary: "#f7e5cf", colourTertiary: "#7a4207" },
  check: { colourPrimary: "#1f7a55", colourSecondary: "#d3efe3", colourTertiary: "#14573c" },
  record: { colourPrimary: "#9b2c55", colourSecondary: "#f9dde7", colourTertiary: "#6f1d3b" },
  act: { colourPrimary: "#0f6a74", colourSecondary: "#d2edf0", colourTertiary: "#0a4b52" },
  raw: { colourPrimary: "#5b6472", colourSecondary: "#e3e6ea", colourTertiary: "#434b57" },
};

/** Blockly's theme in the page's own colours, read from its style sheet. */
export function blocklyTheme(root: HTMLElement): Blockly.Theme {
  const colour = styleOf(root);
  // The name becomes a class of the page's style sheet.
  const name = `ruler-${colour("--canvas").replace("#", "")}`;
  return Blockly.Theme.defineTheme(name, {
    name,
    base: "zelos",
    blockStyles: BLOCK_STYLES as unknown as Record<string, Blockly.Theme.BlockStyle>,
    categoryStyles: {
      rate: { colour: BLOCK_STYLES.rate.colourPrimary },
      rule: { colour: BLOCK_STYLES.rule.colourPrimary },
      check: { colour: BLOCK_STYLES.check.colourPrimary },
      floor: { colour: BLOCK_STYLES.floor.colourPrimary },
      record: { colour: BLOCK_STYLES.record.colourPrimary },
      act: { colour: BLOCK_STYLES.act.colourPrimary },
    },
    componentStyles: {
      workspaceBackgroundColour: colour("--canvas"),
      toolboxBackgroundColour: colour("--surface"),
      toolboxForegroundColour: colour("--text"),
      flyoutBackgroundColour: colour("--surface-2"),
      flyoutForegroundColour: colour("--text"),
      flyoutOpacity: 1,
      scrollbarColour: colour("--line-strong"),
      scrollbarOpacity: 0.6,
      selectedGlowColour: colour("--accent"),
    },
    fontStyle: { family: colour("--font"), weight: "500", size: FONT_PT },
  });
}

const set = (topic: string, hz: number): SetStatement => ({ kind: "set", topic, rate: { kind: "hz", value: hz } });
const check = (topic: string, property: string, op: "<" | ">", value: number): Condition => ({
  kind: "check",
  topic,
  property,
  op,
  value,
});
const rule = (condition: Condition, then: SetStatement[]) =>
  ({ kind: "rule", name: null, priority: 0, condition, then, else: [] }) satisfies RuleStatement;

/** The rule that a new project's first rule block is. */
export const NEW_RULE = rule(check("/odom", "pose_x", ">", 0), [set("/odom", 10)]);
export const NEW_RATE = set("/odom", 10);

/** The blocks to take from: rules and recipes, and what stands inside of rules. */
function toolbox(): Blockly.utils.toolbox.ToolboxDefinition {
  const block = (state: Blockly.serialization.blocks.State) => ({ kind: "block", ...state });
  return {
    kind: "categoryToolbox",
    contents: [
      {
        kind: "category",
        name: "Actions",
        categorystyle: "act",
        contents: ["adirf_notify", "adirf_call", "adirf_parameter"].map((type) => block({ type })),
      },
      { kind: "category", name: "Rules", categorystyle: "rule", contents: [block(toBlock(NEW_RULE))] },
      {
        kind: "category",
        name: "Checks",
        categorystyle: "check",
        contents: ["adirf_check", INSIDE, "adirf_any", "adirf_all", "adirf_not"].map((type) => block({ type })),
      },
      { kind: "category", name: "Recipes", categorystyle: "rule", custom: RECIPES },
    ],
  };
}

type Shown = Blockly.utils.toolbox.FlyoutItemInfo[];

const LOADING = { kind: "label", text: "Loading …" } as Shown[number];

/** The category of the toolbox whose rules are asked for when it is opened first. */
const RECIPES = "RECIPES";

/** Fills the category of recipes, at first with a word until the rules are there. */
function offerRecipes(workspace: Blockly.WorkspaceSvg, recipes: () => Promise<readonly Statement[] | null>): void {
  let shown: Shown | null = null;
  let isAsked = false;
  const ask = async () => {
    isAsked = true;
    const rules = await recipes();
    isAsked = false;
    if (rules === null) return;
    shown = rules.map((each) => ({ kind: "block", ...toBlock(each) }));
    // The page may have been left meanwhile.
    if (workspace.rendered) workspace.refreshToolboxSelection();
  };
  workspace.registerToolboxCategoryCallback(RECIPES, () => {
    if (shown === null && !isAsked) void ask();
    return shown ?? [LOADING];
  });
}
