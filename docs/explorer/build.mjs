// The explorer as one HTML file: `node build.mjs FILE`. build/tables.json is there already.
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const out = process.argv[2] ?? "build/explorer.html";
const made = await build({
  entryPoints: ["src/main.ts"],
  bundle: true,
  minify: true,
  write: false,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "inline",
});
const script = made.outputFiles[0].text.replaceAll("</script", "<\\/script");
const style = (await readFile("src/style.css", "utf8")).trim();
const page = (await readFile("src/index.html", "utf8"))
  .replace("/*STYLE*/", () => `\n${style}\n`)
  .replace("/*SCRIPT*/", () => script);
await writeFile(out, page);
console.log(`${out}: ${Math.round(page.length / 1000)} kB`);
