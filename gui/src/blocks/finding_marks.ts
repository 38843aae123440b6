// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Action, CheckCondition, PlacedFinding, Severity, Statement } from "../api/types";
import { DOCUMENTATION_TAB, findingHref } from "../documentation";
import { checksOf } from "../state/statements";
import { sentence } from "../ui/numbers";
import { ACTION_TYPES } from "./action_model";
import { checksOn } from "./model";
import { withoutLines } from "./rule_words";
import type { Slot } from "./slots";

const SEVERITY_WORDS: Record<Severity, string> = { error: "Error", warning: "Warning", info: "Note" };
const ORDER: readonly Severity[] = ["error", "warning", "info"];
/** Told apart by shape, too: an octagon, a triangle, a circle; and the sign in it. */
const SHAPES: Record<Severity, [shape: string, sign: string]> = {
  error: ["M7 1h10l6 6v10l-6 6H7l-6-6V7z", "M8 8l8 8M16 8l-8 8"],
  warning: ["M12 1.5 23 22H1z", "M12 9v6M12 18.3v.4"],
  info: ["M12 1a11 11 0 1 0 .01 0z", "M12 11v6.5M12 6.4v.4"],
};
const SIZE = 24;
/** Of a bubble, at most. */
const WIDTH_PX = 420;
/** From the top of a block to its mark, and from the left edge of the column. */
const [DOWN, LEFT] = [11, 30];

/** What a mark says, also of what is no finding: why a block is not in the text yet. */
interface Said {
  words: string;
  severity: Severity;
  finding: PlacedFinding | null;
}
type Mend = (finding: PlacedFinding) => void;

/** A mark beside a block, in the gutter of the column; its bubble has the words and the ways to mend. */
class FindingMark extends Blockly.icons.Icon {
  static readonly TYPE = new Blockly.icons.IconType<FindingMark>("finding");
  private said: readonly Said[] = [];
  private bubble: HTMLElement | null = null;

  constructor(
    private readonly block: Blockly.BlockSvg,
    private readonly mend: Mend,
  ) {
    super(block);
  }

  override getType() {
    return FindingMark.TYPE;
  }

  override getSize() {
    return new Blockly.utils.Size(SIZE, SIZE);
  }

  protected override getAriaLabel(): string {
    return `${SEVERITY_WORDS[this.severity]}: ${this.said.map(({ words }) => words).join(" ")}`;
  }

  private get severity(): Severity {
    return ORDER.find((each) => this.said.some(({ severity }) => severity === each)) ?? "info";
  }

  /** Shows what was found, and nothing else than before where that is the same. */
  say(said: readonly Said[]): void {
    if (JSON.stringify(said) !== JSON.stringify(this.said)) {
      this.close();
      this.said = said;
      this.draw();
    }
    this.place();
  }

  /** In the gutter, however deep in its rule the block is. */
  private place(): void {
    const { x } = this.block.getRelativeToSurfaceXY();
    const left = this.block.getRootBlock().getRelativeToSurfaceXY().x;
    this.setOffsetInBlock(new Blockly.utils.Coordinate(left - x - LEFT, DOWN));
  }

  private draw(): void {
    const { svgRoot, severity } = this;
    if (svgRoot === null) return;
    svgRoot.replaceChildren();
    svgRoot.setAttribute("class", `blocklyIconGroup finding-mark ${severity}`);
    const { createSvgElement } = Blockly.utils.dom;
    const { Svg } = Blockly.utils;
    // A finger needs more room than the sign.
    createSvgElement(Svg.RECT, { class: "reach", x: -3, y: -8, width: SIZE + 6, height: SIZE + 16 }, svgRoot);
    const [shape, sign] = SHAPES[severity];
    createSvgElement(Svg.PATH, { class: "shape", d: shape }, svgRoot);
    createSvgElement(Svg.PATH, { class: "sign", d: sign }, svgRoot);
    this.recomputeAriaContext();
  }

  override onClick(): void {
    // A click ends what is open, and comes to its end after this.
    setTimeout(() => this.open());
  }

  private open(): void {
    const box = this.svgRoot?.getBoundingClientRect();
    if (box === undefined || this.bubble !== null) return;
    const bubble = document.createElement("div");
    bubble.className = "finding-bubble";
    bubble.popover = "auto";
    bubble.role = "dialog";
    bubble.ariaLabel = "What was found here";
    bubble.append(...this.said.map((each) => this.entry(each)));
    bubble.style.left = `${Math.max(8, Math.min(box.left, innerWidth - WIDTH_PX - 8))}px`;
    document.body.append(bubble);
    bubble.addEventListener("toggle", (event) => {
      if ((event as ToggleEvent).newState === "closed") this.close();
    });
    this.bubble = bubble;
    bubble.showPopover();
    const { height } = bubble.getBoundingClientRect();
    const isBelow = box.bottom + height + 8 < innerHeight;
    bubble.style.top = `${isBelow ? box.bottom + 4 : Math.max(8, box.top - height - 4)}px`;
    bubble.querySelector<HTMLElement>("button, a")?.focus();
  }

  close(): void {
    const { bubble } = this;
    this.bubble = null;
    bubble?.hidePopover();
    bubble?.remove();
  }

  private entry({ words, severity, finding }: Said): HTMLElement {
    const entry = document.createElement("p");
    const word = document.createElement("strong");
    word.textContent = `${SEVERITY_WORDS[severity]}. `;
    entry.append(word, words, " ");
    if (finding === null) return entry;
    if (finding.fix) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = finding.fix.title;
      button.className = "small fix";
      button.addEventListener("click", () => {
        this.close();
        this.mend(finding);
      });
      entry.append(button, " ");
    }
    const why = document.createElement("a");
    Object.assign(why, { textContent: "Why?", href: findingHref(finding.code), target: DOCUMENTATION_TAB });
    entry.append(why);
    return entry;
  }

  override dispose(): void {
    this.close();
    super.dispose();
  }
}

function saidOf(finding: PlacedFinding, all: readonly Statement[]): Said {
  const said = [finding.message, finding.hint].filter(Boolean).map((each) => `${sentence(withoutLines(each, all))}.`);
  return { words: said.join(" "), severity: finding.severity, finding };
}

/** Blocks as zelos draws them, but that a mark takes no room in them: it moves nothing when it comes. */
class RenderInfo extends Blockly.zelos.RenderInfo {
  protected override createRows_(): void {
    super.createRows_();
    const isMark = (element: object) => "icon" in element && element.icon instanceof FindingMark;
    for (const row of this.inputRows) row.elements = row.elements.filter((element) => !isMark(element));
  }
}

class Renderer extends Blockly.zelos.Renderer {
  protected override makeRenderInfo_(block: Blockly.BlockSvg): RenderInfo {
    return new RenderInfo(this, block);
  }
}

/** The renderer that workspaces name. */
export function rendererName(): string {
  const name = "rules";
  if (!Blockly.registry.hasItem(Blockly.registry.Type.RENDERER, name)) Blockly.blockRendering.register(name, Renderer);
  return name;
}

/** The marks of all blocks; a block is touched only where its mark changes. */
export class FindingMarks {
  private shown = new Map<Blockly.BlockSvg, FindingMark>();

  constructor(private readonly mend: Mend) {}

  /** Shows what findings on the statements `all` say beside their very blocks, and `missing` where a block says nothing yet. */
  show(
    slots: readonly Slot[],
    statements: readonly Statement[],
    findings: readonly PlacedFinding[],
    missing: ReadonlyMap<Blockly.BlockSvg, string>,
    all: readonly Statement[],
  ): void {
    const next = new Map<Blockly.BlockSvg, Said[]>();
    const add = (block: Blockly.BlockSvg, said: Said) => next.set(block, [...(next.get(block) ?? []), said]);
    const numbers = new Map(slots.map((slot, index) => [slot.id, index]));
    for (const finding of findings) {
      for (const id of [finding.statement, ...finding.related]) {
        const index = numbers.get(id ?? "");
        const [slot, statement] = index === undefined ? [] : [slots[index], statements[index]];
        if (!slot || !statement || slot.block.isDisposed()) continue;
        add(id === finding.statement ? blockAt(slot.block, statement, finding) : slot.block, saidOf(finding, all));
      }
    }
    for (const [block, why] of missing)
      add(block, { words: `Not in the text yet. ${why}.`, severity: "warning", finding: null });
    for (const block of this.shown.keys()) {
      if (next.has(block) && !block.isDisposed()) continue;
      if (!block.isDisposed()) takeFrom(block);
      this.shown.delete(block);
    }
    for (const [block, said] of next) {
      const mark = this.shown.get(block) ?? block.addIcon(new FindingMark(block, this.mend));
      this.shown.set(block, mark);
      mark.say(said);
    }
  }
}

/** Takes the mark off a block, which gets the focus if the mark had it. */
function takeFrom(block: Blockly.BlockSvg): void {
  const focus = Blockly.getFocusManager();
  const icon = block.getIcon(FindingMark.TYPE);
  if (icon && focus.getFocusedNode() === icon) focus.focusNode(block);
  block.removeIcon(FindingMark.TYPE);
}

/** The check, rate, bound or recording that a finding stands in, else the whole statement. */
function blockAt(block: Blockly.BlockSvg, statement: Statement, finding: PlacedFinding): Blockly.BlockSvg {
  if (statement.kind !== "rule") return block;
  const base = statement.offset ?? 0;
  const [from, to] = [finding.offset - base, finding.end_offset - base];
  const holds = (part: CheckCondition | Action) => (part.offset ?? 0) <= from && to <= (part.end_offset ?? -1);
  const inner = block.getDescendants(true) as Blockly.BlockSvg[];
  const check = checksOf(statement.condition).findIndex(holds);
  if (check >= 0) return inner.flatMap((each) => Array(checksOn(each)).fill(each))[check] ?? block;
  const action = [...statement.then, ...statement.else].findIndex(holds);
  return inner.filter(({ type }) => ACTION_TYPES.has(type))[action] ?? block;
}
