// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// Tables that sort, and commands that are copied by a click.

document.querySelectorAll("table[data-sortable]").forEach(sortable);
for (const command of document.querySelectorAll("code.command")) {
  const copy = document.createElement("button");
  copy.type = "button";
  copy.textContent = "Copy";
  copy.addEventListener("click", () => {
    getSelection().selectAllChildren(command);
    // A page from a file may have no other clipboard.
    copy.textContent = document.execCommand("copy") ? "Copied" : "Selected";
  });
  command.after(" ", copy);
}
