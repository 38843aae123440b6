// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
const LINE_EVERY_MS = 15_000;

/** Says how far the tests are from time to time, as tests/progress.py does. */
export default class Progress {
  begunMs = Date.now();
  saidMs = this.begunMs;
  files = 0;
  filesDone = 0;
  tests = 0;

  onTestRunStart(specifications) {
    this.files = specifications.length;
  }

  onTestCaseResult(test) {
    this.tests++;
    if (test.result().state === "failed") this.say(`FAILED ${test.module.relativeModuleId} ${test.fullName}`);
    if (Date.now() - this.saidMs < LINE_EVERY_MS || this.filesDone === 0) return;
    this.saidMs = Date.now();
    const leftMs = (Date.now() - this.begunMs) * (this.files / this.filesDone - 1);
    const left = (leftMs / 60_000).toFixed(1);
    this.say(`${this.tests} tests, ${this.filesDone} of ${this.files} files, about ${left} min left`);
  }

  onTestModuleEnd() {
    this.filesDone++;
  }

  say(words) {
    process.stderr.write(`page      ${words}\n`);
  }
}
