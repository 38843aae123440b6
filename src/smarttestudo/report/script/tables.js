// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// Tables that sort by a click on a heading.

function sortable(table) {
  const headings = [...table.tHead.rows[0].cells];
  headings.forEach((heading, column) => {
    const handle = document.createElement("button");
    handle.type = "button";
    handle.append(...heading.childNodes);
    heading.append(handle);
    handle.addEventListener("click", () => {
      const isRising = heading.ariaSort !== "ascending";
      headings.forEach((other) => other.removeAttribute("aria-sort"));
      heading.setAttribute("aria-sort", isRising ? "ascending" : "descending");
      sort(table.tBodies[0], column, isRising ? 1 : -1);
    });
  });
}

// What is missing comes last either way, and sums stay at the foot.
function sort(body, column, direction) {
  const rows = [...body.rows].filter((row) => !row.classList.contains("total"));
  const sums = [...body.rows].filter((row) => row.classList.contains("total"));
  const keyed = rows.map((row) => ({ row, key: sortKey(row.cells[column]) }));
  keyed.sort((one, other) => {
    if (one.key === null || other.key === null) return (one.key === null) - (other.key === null);
    return direction * (typeof one.key === "number" ? one.key - other.key : one.key.localeCompare(other.key));
  });
  body.append(...keyed.map(({ row }) => row), ...sums);
}

function sortKey(cell) {
  const text = cell.textContent;
  if (text === "–") return null;
  if (!cell.classList.contains("right")) return text;
  return Number(text.replaceAll(" ", "").replace("−", "-"));
}
