// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Stands before the search of the site. Options and pasted errors are words, not signs of its queries, and all parts
// of an option must be there. A letter and the words below would be found as the beginning of half of all words, and
// a plural is found as its singular. Of the pages with any of the words, those with most of them are shown.
const SIGNS = /[\s\-+*~^,:!=[\]()"'`/]+/gu;
const SAY_NOTHING = new Set("an and are as at be by can do does for from have how if in is it much my of on or the to what with".split(" "));
const NUMBER = /^\d+$/u;
const MOST_PAGES = 20;
const QUERY = 2;
const RESULT = 3;

const singular = (word) => (word.length > 4 ? word.replace(/(?<!s)s$/u, "") : word);

function query(text) {
  return text.split(/\s+/u).flatMap((typed) => {
    const parts = typed.split(SIGNS).filter((part) => part.length > 1 && !SAY_NOTHING.has(part.toLowerCase()));
    return typed.startsWith("--") && parts.length > 1 ? parts.map((part) => `+${part}*`) : parts.map(singular);
  }).join(" ");
}

function fitting(pages) {
  const found = (sections) => new Set(sections.flatMap(({ terms }) =>
    Object.keys(terms).filter((term) => terms[term] && !NUMBER.test(term))));
  const counts = pages.map((sections) => found(sections).size);
  const most = Math.max(...counts);
  const enough = most > 2 ? most - 1 : most;
  return pages.filter((_, index) => counts[index] >= enough).slice(0, MOST_PAGES);
}

addEventListener("message", ({ data }) => {
  if (data.type === QUERY) data.data = query(data.data);
});

const send = postMessage;
postMessage = (message) => {
  if (message.type === RESULT) message.data.items = fitting(message.data.items);
  send.call(self, message);
};
