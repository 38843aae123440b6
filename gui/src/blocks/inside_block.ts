// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { CheckCondition } from "../api/types";
import { CLOCK_METHODS, change, chooseTime } from "./clocks";
import { ChoiceField, CLOCK, CONDITION, chain, MINUS, quietButton, type Suggestions } from "./fields";
import { type ClockState, checkStack, insideChecks } from "./model";
import { openField } from "./open_field";
import { INSIDE, NEW_ZONE, placeOf, rectangleOf, sidesOf, zoneName, zonePicture, zoneText } from "./zones";

interface InsideButtons {
  remove(block: Blockly.BlockSvg): void;
  /** Lets somebody draw the zone of a block on the map. */
  drawZone(block: Blockly.BlockSvg): void;
}

interface InsideState extends ClockState {
  hasNumbers?: boolean;
}

const [WIDTH, HEIGHT] = [42, 30];
const DRAW = "draw";
const NUMBERS = "numbers";

export function defineInside(suggest: Suggestions, { remove, drawZone }: InsideButtons): void {
  Blockly.Blocks[INSIDE] = {
    init(this: Blockly.BlockSvg) {
      const zone = new ZoneField(suggest, drawZone);
      this.appendDummyInput()
        .appendField("", "JOIN")
        .appendField("inside")
        .appendField(new Picture(zone.picture, WIDTH, HEIGHT), "PLACE")
        .appendField(zone as Blockly.FieldDropdown, "ZONE")
        .appendField(quietButton(CLOCK, "Add time", chooseTime), "CLOCK")
        .appendField(quietButton(MINUS, "Remove this zone", remove));
      chain(this, CONDITION, "check");
      this.setTooltip(() => {
        const checks = insideChecks(this) as CheckCondition[];
        return `Holds while ${checks[0]?.topic} is in ${sidesOf(checks)}. In the text it is four checks.`;
      });
    },
    saveExtraState(this: Blockly.BlockSvg): InsideState | null {
      const clocks = CLOCK_METHODS.saveExtraState.call(this);
      return hasNumbers(this) ? { ...clocks, hasNumbers: true } : clocks;
    },
    loadExtraState(this: Blockly.BlockSvg, state: InsideState) {
      if (state.hasNumbers) this.appendStatementInput("TERMS").setCheck(CONDITION);
      CLOCK_METHODS.loadExtraState.call(this, state);
    },
  };
}

/** Whether a block of a zone shows its four checks. */
export function hasNumbers(block: Blockly.Block): boolean {
  return block.type === INSIDE && block.getInput("TERMS") !== null;
}

/** Shows the checks of a zone in its block, or only what they are called. */
export function showNumbers(block: Blockly.BlockSvg, isShown: boolean): void {
  if (isShown === hasNumbers(block)) return;
  const checks = insideChecks(block) as CheckCondition[];
  if (!isShown) {
    block.getInputTargetBlock("TERMS")?.dispose(false);
    block.removeInput("TERMS");
    block.setFieldValue(zoneText(checks), "ZONE");
    return;
  }
  const { connection } = block.appendStatementInput("TERMS").setCheck(CONDITION);
  if (block.getInput("TIME0")) block.moveInputBefore("TERMS", "TIME0");
  if (connection === null) return;
  Blockly.serialization.blocks.append(checkStack(checks), block.workspace).previousConnection?.connect(connection);
}

/** What the name beside it says already. */
class Picture extends Blockly.FieldImage {
  override computeAriaLabel(): string {
    return "";
  }
}

/** The zones of the file to choose from, and what else can be done with one. */
export class ZoneField extends ChoiceField {
  private shown = "";

  constructor(
    private readonly suggest: Suggestions,
    private readonly draw: (block: Blockly.BlockSvg) => void,
  ) {
    super(Blockly.Field.SKIP_SETUP);
    this.setAriaTypeName("zone");
    this.setOptions(() => this.choices());
  }

  get picture(): string {
    return zonePicture(this.checks, this.suggest.zones());
  }

  /** Says again what the zone is called, and how it lies among others, where that has changed. */
  refresh(): void {
    const shown = [this.getText(), placeOf(this.checks), ...this.suggest.zones().map(({ place }) => place)].join();
    if (shown === this.shown) return;
    this.shown = shown;
    this.getSourceBlock()?.setFieldValue(this.picture, "PLACE");
    this.forceRerender();
    this.recomputeAriaContext();
  }

  private get checks(): CheckCondition[] {
    const block = this.getSourceBlock();
    return block?.getField("ZONE") ? (insideChecks(block) as CheckCondition[]) : this.first;
  }

  private get first(): CheckCondition[] {
    return [...(this.suggest.zones()[0]?.checks ?? NEW_ZONE)];
  }

  private choices(): Blockly.MenuOption[] {
    const { checks } = this;
    const zones = this.suggest.zones();
    const isZone = rectangleOf(checks) !== null;
    const isOpen = this.getSourceBlock() !== null && hasNumbers(this.getSourceBlock() as Blockly.Block);
    const others = zones.filter(({ place }) => place !== placeOf(checks));
    return [
      [zoneName(checks, zones), this.getValue() ?? zoneText(checks)],
      ...others.map((each): Blockly.MenuOption => [each.name, zoneText(each.checks)]),
      "separator",
      ...(isZone ? [["Draw on the map", DRAW] as Blockly.MenuOption] : []),
      ...(isZone || !isOpen ? [[isOpen ? "Hide the numbers" : "Show the numbers", NUMBERS] as Blockly.MenuOption] : []),
    ];
  }

  // A block that is pasted may have a zone that no rule of this file has.
  protected override doClassValidation_(text?: string): string | null {
    return text ?? null;
  }

  protected override getText_(): string {
    return zoneName(this.checks, this.suggest.zones());
  }

  override getAriaValue(): string {
    return this.getText();
  }

  protected override onItemSelected_(_menu: Blockly.Menu, item: Blockly.MenuItem): void {
    const block = this.getSourceBlock() as Blockly.BlockSvg;
    const value = String(item.getValue());
    if (value === DRAW) this.draw(block);
    else if (value === NUMBERS) {
      const isShown = !hasNumbers(block);
      change(block, () => showNumbers(block, isShown));
      if (isShown) openField(block.getInputTargetBlock("TERMS")?.getField("VALUE") ?? null);
    } else if (value !== this.getValue()) {
      change(block, () => showNumbers(block, false));
      this.setValue(value);
    }
  }
}
