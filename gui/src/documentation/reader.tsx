// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useSignal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { Contents, Documentation } from "./documentation";
import { type FoundSection, foundSections, type Section } from "./found_sections";

interface ShownSection extends Section {
  heading: Element;
}

const HEADINGS = "h2, h3";
const MOST = 40;

/** The documentation with its contents and a search; `anchor` is the place to show, "" for the beginning. */
export function DocumentationReader({ anchor, isSearchFirst }: { anchor: string; isSearchFirst: boolean }) {
  const prose = useRef<HTMLElement>(null);
  const query = useSignal("");
  const [sections, setSections] = useState<readonly ShownSection[]>([]);
  useEffect(() => setSections(prose.current === null ? [] : sectionsOf(prose.current)), []);
  const show = (heading: Element | null | undefined) => {
    query.value = "";
    // It can be scrolled to once it is shown again.
    requestAnimationFrame(() => heading?.scrollIntoView());
  };
  useEffect(() => {
    // Errors of syntax explain themselves; what they are about is the language.
    if (anchor) show(document.getElementById(anchor) ?? document.getElementById("language"));
  }, [anchor]);
  const found = foundSections(sections, query.value);
  return (
    <div class="help">
      <div class="contents-side">
        <SearchField query={query.value} change={(text) => (query.value = text)} {...{ found, show, isSearchFirst }} />
        <Contents />
      </div>
      <main class="prose" ref={prose} hidden={query.value !== ""}>
        <Documentation />
      </main>
    </div>
  );
}

interface SearchProps {
  query: string;
  found: readonly FoundSection<ShownSection>[];
  isSearchFirst: boolean;
  change: (query: string) => void;
  show: (heading: Element) => void;
}

/** A field to search with, and below it the list of what was found: a combobox with a listbox. */
function SearchField({ query, found, isSearchFirst, change, show }: SearchProps) {
  const active = useSignal(0);
  const shown = found.slice(0, MOST);
  const press = (event: KeyboardEvent) => {
    const last = shown.length - 1;
    const chosen = shown[active.value];
    if (event.key === "Enter" && chosen) show(chosen.section.heading);
    else if (event.key === "ArrowDown") active.value = Math.min(active.value + 1, last);
    else if (event.key === "ArrowUp") active.value = Math.max(active.value - 1, 0);
    else if (event.key === "Escape" && query !== "") change("");
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <search class="documentation-search">
      <input
        autofocus={isSearchFirst}
        type="search"
        // biome-ignore lint/a11y/noRedundantRoles: its list is not a datalist
        role="combobox"
        list={undefined}
        aria-label="Search the documentation"
        aria-expanded={query !== ""}
        aria-controls="found-sections"
        aria-activedescendant={shown.length > 0 ? `found-section-${active.value}` : undefined}
        placeholder="Search"
        value={query}
        onInput={(event) => {
          active.value = 0;
          change(event.currentTarget.value);
        }}
        onKeyDown={press}
      />
      {query !== "" && (
        <>
          <p class="quiet" role="status">
            {found.length === 0 ? "Nothing has all of these words." : `${found.length} found`}
          </p>
          <div role="listbox" id="found-sections" aria-label="Found in the documentation" tabIndex={-1}>
            {shown.map(({ section, excerpt }, at) => (
              // The keyboard chooses in the field above.
              // biome-ignore lint/a11y/useKeyWithClickEvents: see above
              // biome-ignore lint/a11y/useFocusableInteractive: see above
              <div
                key={at}
                id={`found-section-${at}`}
                role="option"
                aria-selected={at === active.value}
                onClick={() => show(section.heading)}
              >
                <strong>{section.title}</strong>
                {section.title !== section.chapter && <span class="quiet"> {section.chapter}</span>}
                <p class="quiet">{excerpt}</p>
              </div>
            ))}
          </div>
        </>
      )}
    </search>
  );
}

/** The sections of what is shown, by its headings. */
function sectionsOf(prose: HTMLElement): ShownSection[] {
  let chapter = "";
  const headings = [...prose.querySelectorAll(HEADINGS)];
  return headings.map((heading, at) => {
    const title = heading.textContent ?? "";
    if (heading.tagName === "H2") chapter = title;
    const range = document.createRange();
    range.setStartAfter(heading);
    const next = headings[at + 1];
    if (next) range.setEndBefore(next);
    else range.setEndAfter(prose.lastChild ?? heading);
    return { title, chapter, text: range.toString().replace(/\s+/g, " ").trim(), heading };
  });
}
