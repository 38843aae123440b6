// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { diskChangeOf } from "../../src/state/open_file";
import { EXAMPLE_RULES, ExampleApi } from "../../src/tour/tour_page";

test("the example is never missed on the disk", async () => {
  const api = new ExampleApi();
  const { hash } = await api.read(EXAMPLE_RULES);
  expect(await diskChangeOf(api, EXAMPLE_RULES, hash)).toBeNull();
});
