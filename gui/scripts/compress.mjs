// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Writes beside each file of the page what is sent of it: NAME.br and NAME.gz, where that is smaller.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";

const ROOT = new URL("../../src/smarttestudo/ruler/server/static/", import.meta.url);
const TEXTS = /\.(js|css|html|svg)$/;
const LEAST_BYTES = 500;

const brotli = (data) =>
  brotliCompressSync(data, {
    params: {
      [constants.BROTLI_PARAM_MODE]: constants.BROTLI_MODE_TEXT,
      [constants.BROTLI_PARAM_QUALITY]: constants.BROTLI_MAX_QUALITY,
      [constants.BROTLI_PARAM_SIZE_HINT]: data.length,
    },
  });
const gzip = (data) => gzipSync(data, { level: constants.Z_BEST_COMPRESSION });

for (const entry of readdirSync(ROOT, { recursive: true, withFileTypes: true })) {
  if (!entry.isFile() || !TEXTS.test(entry.name)) continue;
  const file = `${entry.parentPath}/${entry.name}`;
  const data = readFileSync(file);
  for (const [suffix, compress] of [
    ["br", brotli],
    ["gz", gzip],
  ]) {
    const smaller = compress(data);
    if (data.length >= LEAST_BYTES && smaller.length < data.length) writeFileSync(`${file}.${suffix}`, smaller);
  }
}
