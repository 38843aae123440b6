// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import axe from "axe-core";
import { commands } from "vitest/browser";
import { resize, twoPictures } from "./ruler_page";

/** A laptop, a tablet and a telephone. */
const WIDTHS_PX = [1280, 820, 390];
const HEIGHT_PX = 900;
const SWEEPS = (["light", "dark"] as const).flatMap((scheme) => WIDTHS_PX.map((width) => ({ scheme, width })));
/** All else that axe-core looks at is the same in both schemes. */
const OF_COLOURS = ["color-contrast", "link-in-text-block"];
/** Colours change at once, so that none is measured half way. */
const STILL = new CSSStyleSheet();
STILL.replaceSync("*, *::before, *::after { transition: none !important; animation: none !important }");

/** What axe-core reports, on light and dark screens of all widths; the page is as wide as before after it. */
export async function violations(): Promise<string[]> {
  const before = { width: innerWidth, height: innerHeight };
  const sweeps = (await commands.isBrief()) ? SWEEPS.filter((_, at) => at === 0 || at === SWEEPS.length - 1) : SWEEPS;
  document.adoptedStyleSheets = [STILL];
  const found: string[] = [];
  const lookedAt = new Set<number>();
  for (const { scheme, width } of sweeps) {
    await commands.colorScheme(scheme);
    await resize(width, HEIGHT_PX);
    await twoPictures();
    const said = await look(lookedAt.has(width));
    found.push(...said.map((each) => `${scheme}, ${width} px: ${each}`));
    lookedAt.add(width);
  }
  await commands.colorScheme("light");
  document.adoptedStyleSheets = [];
  await resize(before.width, before.height);
  return found;
}

async function look(isOfColours: boolean): Promise<string[]> {
  // The size of what is pressed, 24 px or as much space around it, is of WCAG 2.2: axe-core asks for it if told.
  const options: axe.RunOptions = { resultTypes: ["violations"], rules: { "target-size": { enabled: true } } };
  if (isOfColours) options.runOnly = { type: "rule", values: OF_COLOURS };
  return (await axe.run(document, options)).violations.flatMap(({ id, nodes }) =>
    nodes.map(({ target, html, failureSummary }) => `${id}: ${target} ${html.slice(0, 120)} ${failureSummary}`),
  );
}
