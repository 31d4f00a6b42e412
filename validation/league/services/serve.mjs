// Answers the grader for one method of an npm package: `node serve.mjs METHOD.json`, beside
// `adapter.mjs` and the kit for JavaScript. METHOD.json has the `function` of the adapter, the
// `options` that are passed to it last, and the `declaration`.
import { appendFileSync, readFileSync, writeFileSync } from "node:fs";
import { serve } from "./isograde.mjs";

const method = JSON.parse(readFileSync(process.argv[2], "utf8"));
const adapter = await import("./adapter.mjs");
await serve(method.declaration, (values, shape, isovalue, spacing) =>
  costed(() => adapter[method.function](values, shape, isovalue, spacing, method.options)),
);

/** What a function gives; what it costs is a line of the file that ISOGRADE_COST names. */
function costed(call) {
  const path = process.env.ISOGRADE_COST;
  if (!path) return call();
  const before = memory("VmRSS:");
  try {
    writeFileSync("/proc/self/clear_refs", "5");
  } catch {
    // Not on Linux: the memory is not measured.
  }
  const used = process.cpuUsage();
  const start = performance.now();
  const found = call();
  const seconds = (performance.now() - start) / 1000;
  const { user, system } = process.cpuUsage(used);
  const more = memory("VmHWM:") - before;
  appendFileSync(path, `${seconds} ${(user + system) / 1e6} ${more}\n`);
  return found;
}

/** Kilobytes of this process, as Linux counts them; 0 elsewhere. */
function memory(name) {
  try {
    const line = readFileSync("/proc/self/status", "utf8").split("\n").find((one) => one.startsWith(name));
    return Number(line.split(/\s+/)[1]);
  } catch {
    return 0;
  }
}
