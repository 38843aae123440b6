// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const BLOCKLY_MEDIA = new URL("./node_modules/blockly/media/", import.meta.url);

/** Puts Blockly's pictures beside the page: by default Blockly loads them from the internet. */
function blocklyMedia() {
  return {
    name: "blockly-media",
    apply: "build",
    generateBundle() {
      for (const file of readdirSync(BLOCKLY_MEDIA)) {
        this.emitFile({
          type: "asset",
          fileName: `media/${file}`,
          source: readFileSync(new URL(file, BLOCKLY_MEDIA)),
        });
      }
    },
  };
}

export default defineConfig({
  base: "./",
  plugins: [blocklyMedia()],
  // The module of the same name has a function for each message.
  resolve: { alias: { "blockly/msg/en": fileURLToPath(new URL("./node_modules/blockly/msg/en.js", import.meta.url)) } },
  build: {
    outDir: "../src/smarttestudo/ruler/server/static",
    emptyOutDir: true,
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
    chunkSizeWarningLimit: 1500,
    // Each file takes the browser and the server longer than the code in it.
    rolldownOptions: {
      output: { codeSplitting: { groups: [{ name: "shared", test: /gui.src|preact/, minShareCount: 5 }] } },
    },
  },
  server: {
    proxy: {
      "/api": "http://127.0.0.1:8750",
      "/documentation": "http://127.0.0.1:8750",
      "/ws": { target: "ws://127.0.0.1:8750", ws: true },
    },
  },
});
