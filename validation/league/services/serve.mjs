// Answers the grader for one method of an npm package: `node serve.mjs METHOD.json`, beside
// `adapter.mjs` and the kit for JavaScript. METHOD.json has the `function` of the adapter, the
// `options` that are passed to it last, and the `declaration`.
import { readFileSync } from "node:fs";
import { serve } from "./isograde.mjs";

const method = JSON.parse(readFileSync(process.argv[2], "utf8"));
const adapter = await import("./adapter.mjs");
await serve(method.declaration, (values, shape, isovalue, spacing) =>
  adapter[method.function](values, shape, isovalue, spacing, method.options),
);
