// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Stands before the search of the site: options and pasted errors are words, not signs of its queries. All parts of
// an option must be there. A letter and the words below would be found as the beginning of half of all words.
const SIGNS = /[\s\-+*~^,:!=[\]()"'`/]+/u;
const SAY_NOTHING = new Set("an and are as at be by can do does for from have how if in is it much my of on or the to what with".split(" "));

addEventListener("message", ({ data }) => {
  const isQuery = data.type === 2;
  if (!isQuery) return;
  const words = data.data.split(/\s+/u).flatMap((text) => {
    const parts = text.split(SIGNS).filter((part) => part.length > 1 && !SAY_NOTHING.has(part.toLowerCase()));
    return text.startsWith("--") && parts.length > 1 ? parts.map((part) => `+${part}*`) : parts;
  });
  data.data = words.join(" ") || data.data.replaceAll(SIGNS, " ");
});
