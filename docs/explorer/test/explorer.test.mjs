// The explorer as its readers use it: by mouse, finger and keys, wide and narrow, in both themes.
// `npm test`, with Debian's chromium; tests/docs/test_explorer.py compares its numbers with isoref.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const PAGE = new URL("../explorer.html", import.meta.url).href;
const FLAGS = [
  "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
  // Without a graphics card the pictures cost most of the time: fewer pixels, the same page.
  "--webgl-antialiasing-mode=none",
];
const TABS = ["cell", "gallery", "pair", "field", "plane", "four"];
const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** @type {string} */
let profile;
/** @type {import("playwright-core").BrowserContext} */
let context;
/** @type {import("playwright-core").Page} */
let page;
/** @type {string[]} */
let errors = [];

/** A page of this size and taste, in a browser with these flags more.
 * @param {import("playwright-core").BrowserContextOptions} options @param {string[]} flags */
async function open(options = {}, flags = []) {
  profile = mkdtempSync(join(tmpdir(), "explorer-"));
  const executablePath = BROWSERS.find((one) => existsSync(one));
  context = await chromium.launchPersistentContext(profile, {
    executablePath, headless: true, args: [...FLAGS, ...flags], viewport: { width: 1300, height: 900 },
    deviceScaleFactor: 0.5, ...options,
  });
  page = context.pages()[0] ?? (await context.newPage());
  errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("request", (request) => request.url().startsWith("file:") || errors.push(`it asks for ${request.url()}`));
}

async function close() {
  await context.close();
  rmSync(profile, { recursive: true, force: true });
  assert.deepEqual(errors, []);
}

/** Open this link in a page of its own, and wait for a frame. @param {string} hash */
async function show(hash = "") {
  await page.goto("about:blank");
  await page.goto(PAGE + hash);
  await frames();
}

/** Let two frames pass. */
const frames = () =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Follow this link inside the page, which costs less than to open it. @param {string} hash */
async function follow(hash) {
  await page.evaluate((hash) => void (location.hash = hash), hash);
  await frames();
}

/** What the program holds. @param {string} what @returns {Promise<any>} */
const held = (what) => page.evaluate(`explorer.${what}`);

before(() => open());
after(close);

test("corners are typed", async () => {
  await show();
  const input = page.locator(".typed input").first();
  await input.fill("2.5");
  await frames();
  assert.equal((await held("app.state.cell.values"))[0], 2.5);
  assert.equal(await page.locator(".handle").first().textContent(), "2.5");
  await input.fill("");
  assert.equal((await held("app.state.cell.values"))[0], 2.5, "an empty box changes nothing");
});

test("corners are dragged, up for more", async () => {
  await show();
  const handle = page.locator(".handle").nth(7);
  const before = (await held("app.state.cell.values"))[7];
  const box = await handle.boundingBox();
  assert.ok(box);
  await page.mouse.move(box.x + 8, box.y + 8);
  await page.mouse.down();
  await page.mouse.move(box.x + 8, box.y - 32, { steps: 4 });
  await page.mouse.up();
  await frames();
  assert.ok((await held("app.state.cell.values"))[7] > before);
  assert.equal(await page.locator(".typed input").nth(7).inputValue(), String((await held("app.state.cell.values"))[7]));
});

test("corners are moved by keys, and Enter goes to the box", async () => {
  await show();
  const handle = page.locator(".handle").nth(2);
  await handle.focus();
  const before = (await held("app.state.cell.values"))[2];
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("ArrowDown");
  await frames();
  assert.ok((await held("app.state.cell.values"))[2] > before);
  assert.equal(await handle.getAttribute("aria-valuenow"), String((await held("app.state.cell.values"))[2]));
  await page.keyboard.press("Enter");
  const label = await page.evaluate(() => document.activeElement?.getAttribute("aria-label"));
  assert.equal(label, "sample 010");
});

test("pictures turn together by mouse and keys, and go back", async () => {
  await show();
  const place = page.locator(".place").nth(1);
  const shots = [await page.locator(".stage").screenshot()];
  await place.focus();
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("+");
  const turned = await held("stage.view");
  const start = await held("START");
  assert.notDeepEqual(turned, start);
  await frames();
  shots.push(await page.locator(".stage").screenshot());
  assert.notDeepEqual(shots[0], shots[1]);
  await page.locator("#home").click();
  assert.deepEqual(await held("stage.view"), start);
  const box = await place.boundingBox();
  assert.ok(box);
  await page.mouse.move(box.x + 60, box.y + 60);
  await page.mouse.down();
  await page.mouse.move(box.x + 100, box.y + 70, { steps: 3 });
  await page.mouse.up();
  assert.deepEqual(await held("stage.view"), { turn: start.turn - 20, tilt: start.tilt + 5, zoom: 1 });
});

test("the isovalue passes a tunnel", async () => {
  await show();
  // The names on the way, from the lowest isovalue to the highest.
  const names = await page.evaluate(async () => {
    const slider = /** @type {HTMLInputElement} */ (document.querySelector(".rail input"));
    const seen = new Set();
    for (let at = 0; at <= 1000; at += 20) {
      slider.value = String(at);
      slider.dispatchEvent(new Event("input"));
      // The page asked for its frame first.
      await new Promise((done) => requestAnimationFrame(done));
      seen.add(document.querySelector(".facts tr:nth-child(3) td")?.textContent);
    }
    return [...seen];
  });
  assert.ok(names.indexOf("4.2") > 0, names.join());
  assert.ok(names.indexOf("4.1") > names.indexOf("4.2"), "above the body saddle two caps are left");
  assert.ok(await page.locator(".marks .at-body").count(), "the saddle is marked on the rail");
});

test("every case of Chernyaev begins with a cell of that name", async () => {
  await show();
  const names = await page.locator(".presets option").evaluateAll((all) =>
    all.map((one) => /** @type {HTMLOptionElement} */ (one).value).filter(Boolean));
  assert.equal(names.length, 32);
  for (const name of ["0", "3.2", "7.4.2", "10.1.2", "13.5.2"]) {
    await page.locator(".presets select").selectOption(name);
    await frames();
    assert.equal(await page.locator(".facts tr").nth(2).locator("td").textContent(), name);
  }
});

test("the gallery has 256 signs, and each leads to its cell", async () => {
  await show("#tab=gallery");
  const thumbs = page.locator(".configuration .thumb[aria-label]");
  assert.equal(await thumbs.count(), 256);
  await page.locator('.thumb[aria-label^="signs 105,"]').click();
  const variants = page.locator(".variants .thumb");
  assert.ok((await variants.count()) >= 64, "all decisions of configuration 13");
  assert.ok(await page.locator(".variants .never").count(), "some of them never occur");
  await page.locator(".variants .thumb:not(.never)", { hasText: "13.5.2" }).first().click();
  await frames();
  assert.equal(await held("app.state.tab"), "cell");
  assert.equal(await page.locator(".facts tr").nth(2).locator("td").textContent(), "13.5.2");
});

test("a link says whose tiles the gallery shows", async () => {
  await show("#tab=gallery&tiles=marching-vesta-disconnect-L");
  const chosen = page.locator(".side select");
  assert.equal(await chosen.inputValue(), "marching-vesta-disconnect-L");
  await chosen.selectOption("lorensen-cline");
  await page.locator("#link").click();
  assert.match(page.url(), /tiles=lorensen-cline/);
  await follow("#tab=gallery&tiles=magic");
  assert.match((await page.locator("#said").textContent()) ?? "", /no algorithm "magic"/);
});

test("the canvas lies over the page only where there are pictures in space", async () => {
  for (const tab of TABS) {
    // Opened there: a canvas in which nothing was ever drawn is black in some browsers.
    await show(`#tab=${tab}`);
    const seen = await page.locator(".canvas").isVisible();
    assert.equal(seen, !["gallery", "plane"].includes(tab), tab);
  }
});

test("the hole of 1987 is open, and nobody else's", async () => {
  await show("#tab=pair");
  const said = await page.locator("figcaption").allTextContents();
  assert.match(said[1], /a hole: 4 open edges/);
  for (const one of said.slice(2)) assert.match(one, /closed; 0 of 2/);
});

test("a wrong cell of the field opens as a cell that is wrong", async () => {
  await show("#tab=field");
  const rules = await held("app.state.rules");
  assert.ok(rules.includes("asymptotic-decider"));
  await page.locator(".wrong p", { hasText: "Asymptotic" }).locator("button").first().click();
  await frames();
  assert.equal(await held("app.state.tab"), "cell");
  const said = await page.locator("figcaption", { hasText: "Asymptotic" }).textContent();
  assert.match(said ?? "", /a tunnel is missing/);
});

test("a link carries what is seen, for every tab", async () => {
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await show();
  for (const tab of TABS) {
    await follow(`#tab=${tab}`);
    await page.evaluate(() => {
      const { app, stage } = /** @type {any} */ (window).explorer;
      stage.turn(33, 5);
      const lattice = app.state[app.state.tab];
      if (lattice) {
        lattice.isovalue = 0.125;
        lattice.values = lattice.values.map((/** @type {number} */ x, /** @type {number} */ i) => x + i / 1024);
        Object.assign(lattice, { kind: "", seed: 0 });
      }
      app.changed();
    });
    await page.locator("#link").click();
    const link = page.url();
    const wanted = await held("app.state");
    await page.goto("about:blank");
    await page.goto(link);
    await frames();
    const state = await held("app.state");
    assert.deepEqual(state[tab], wanted[tab], tab);
    assert.deepEqual([state.tab, state.view], [tab, wanted.view]);
  }
});

test("a link that cannot be read says why", async () => {
  const bad = [
    ["#tab=nowhere", "there is no tab"],
    ["#tab=cell&n=2,2,2&v=1,2,x,4,5,6,7,8", "no finite number"],
    ["#tab=cell&n=2,2,2&v=1,2,3", "v holds 3 samples"],
    ["#tab=field&n=100,100,100&v=1", "at most"],
    ["#tab=field&kind=moon", "no kind of field"],
    ["#tab=cell&i=Infinity", "no finite number"],
    ["#tab=cell&r=magic", "no algorithm"],
    ["#tab=cell&n=2,2,2&v=<img src=x onerror=alert(1)>", "no finite number"],
  ];
  for (const [n, [link, words]] of bad.entries()) {
    // The first and the last as the page opens, the others inside it.
    await (n && n < bad.length - 1 ? follow : show)(link);
    const said = (await page.locator("#said").textContent()) ?? "";
    assert.ok(said.includes("could not be read") && said.includes(words), `${link}: ${said}`);
    assert.ok(await page.locator(".tabs [aria-selected=true]").count(), "something is shown all the same");
    assert.equal(await page.locator("img").count(), 0);
  }
});

test("samples are pasted as a list of any form", async () => {
  await show();
  await page.locator(".side details summary").first().click();
  await page.locator("textarea").fill("array([[[1., -2e-1], [.5, 4]], [[5, 6], [7, -8.]]])");
  await page.locator("text=take these").click();
  assert.deepEqual(await held("app.state.cell.values"), [1, -0.2, 0.5, 4, 5, 6, 7, -8]);
  await page.locator("textarea").fill("1 2 3");
  await page.locator("text=take these").click();
  assert.match((await page.locator("details [role=status]").first().textContent()) ?? "", /3 numbers/);
});

test("tabs are reached by arrow keys", async () => {
  await show();
  await page.locator(".tabs [aria-selected=true]").focus();
  const seen = [];
  for (const _ of TABS) {
    seen.push(await held("app.state.tab"));
    await page.keyboard.press("ArrowRight");
  }
  assert.deepEqual(seen, TABS);
  assert.equal(await held("app.state.tab"), "cell");
});

test("everything that can be used has a name", async () => {
  await show();
  for (const tab of TABS) {
    await follow(`#tab=${tab}`);
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll("button, input, select, textarea, [role=slider], [role=application]")]
        .filter((one) => !one.getAttribute("aria-label") && !one.textContent?.trim() && !one.closest("label")?.textContent?.trim())
        .map((one) => one.outerHTML.slice(0, 120)));
    assert.deepEqual(nameless, [], tab);
  }
});

test("a frame of one cell costs at most 8 ms of script", async (t) => {
  await show();
  // Processor time of the page's thread, so that a busy machine does not count.
  const session = await context.newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const spent = async () => {
    const { metrics } = await session.send("Performance.getMetrics");
    return 1000 * (metrics.find((one) => one.name === "ScriptDuration")?.value ?? NaN);
  };
  /** Change a sample n times, a frame each. @param {number} n */
  const run = (n) =>
    page.evaluate(async (n) => {
      const { app } = /** @type {any} */ (window).explorer;
      for (let i = 0; i < n; i++) {
        app.state.cell.values = [0.9 - i / 500, -0.35, -0.5, -0.45, -0.3, -0.3, -0.4 + i / 900, 0.8];
        app.changed();
        await new Promise((done) => requestAnimationFrame(done));
      }
    }, n);
  await run(20);
  const start = await spent();
  await run(40);
  const each = ((await spent()) - start) / 40;
  t.diagnostic(`${each.toFixed(2)} ms of script a frame`);
  assert.ok(each > 0.1, "something was measured");
  assert.ok(each <= 8, `${each.toFixed(2)} ms of script a frame`);
});

test("text stands out, in both themes", async () => {
  for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
    await page.emulateMedia({ colorScheme });
    await show();
    for (const tab of TABS) {
      await follow(`#tab=${tab}`);
      const dim = await page.evaluate(() => {
        /** @param {string} text */
        const parse = (text) => (text.match(/[\d.]+/g) ?? []).map(Number);
        /** @param {number[]} rgb */
        const light = ([r, g, b]) => {
          const [x, y, z] = [r, g, b].map((v) => (v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
          return 0.2126 * x + 0.7152 * y + 0.0722 * z;
        };
        /** @param {Element} element */
        const behind = (element) => {
          for (let node = /** @type {Element | null} */ (element); node; node = node.parentElement) {
            const rgba = parse(getComputedStyle(node).backgroundColor);
            if (rgba.length === 3 || rgba[3] > 0.99) return rgba;
          }
          return [255, 255, 255];
        };
        const found = [];
        for (const one of document.querySelectorAll("body *:not(svg *):not(script):not(style):not(.never *)")) {
          const own = [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent?.trim());
          if (!own || !one.getClientRects().length) continue;
          const [a, b] = [light(parse(getComputedStyle(one).color)), light(behind(one))];
          const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
          if (contrast < 4.5) found.push(`${one.tagName}.${one.className} ${one.textContent?.slice(0, 30)} ${contrast.toFixed(2)}`);
        }
        return found;
      });
      assert.deepEqual(dim, [], `${tab}, ${colorScheme}`);
    }
  }
  await page.emulateMedia({ colorScheme: "light" });
});

test("pictures are where their panels are, whatever is scrolled", async () => {
  await close();
  await open({ viewport: { width: 390, height: 700 }, deviceScaleFactor: 1.5 });
  await show();
  for (let n = 0; n < 5; n++) {
    const place = page.locator(".place").nth(n);
    await place.scrollIntoViewIfNeeded();
    await frames();
    await frames();
    // Colours in the upper and the lower half: the picture is neither absent nor cut.
    const box = await place.boundingBox();
    assert.ok(box);
    const { x, y, width, height } = box;
    const shot = await page.screenshot({ clip: { x, y, width, height } });
    const halves = await page.evaluate(async (bytes) => {
      const file = Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0));
      const image = await createImageBitmap(new Blob([file], { type: "image/png" }));
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      const coloured = [0, 0];
      for (let i = 0; i < data.length; i += 4)
        if (Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 60)
          coloured[Number(i >= data.length / 2)]++;
      return coloured.map((count) => count / (data.length / 8));
    }, shot.toString("base64"));
    for (const share of halves)
      assert.ok(share > 0.005, `panel ${n}: ${(100 * share).toFixed(2)} % of a half is coloured`);
  }
  await close();
  await open();
});

test("who wants less motion gets steps", async () => {
  await page.emulateMedia({ reducedMotion: "reduce" });
  await show();
  const changes = await page.evaluate(async () => {
    const { app } = /** @type {any} */ (window).explorer;
    const seen = new Set();
    /** @type {HTMLElement} */ (document.querySelector(".play")).click();
    const end = performance.now() + 1500;
    while (performance.now() < end) {
      seen.add(app.state.cell.isovalue);
      await new Promise((done) => requestAnimationFrame(done));
    }
    /** @type {HTMLElement} */ (document.querySelector(".play")).click();
    return seen.size;
  });
  assert.ok(changes >= 2 && changes <= 5, `${changes} values in a second and a half`);
  await page.emulateMedia({ reducedMotion: null });
});

test("on a telephone nothing is wider than the screen, and fingers turn and drag", async () => {
  await close();
  await open({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
  await show();
  for (const tab of TABS) {
    await follow(`#tab=${tab}`);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 390, `${tab} is ${wide} wide`);
    const small = await page.evaluate(() =>
      [...document.querySelectorAll("button:not(.small):not(.thumb), select")].filter((one) => {
        const box = one.getBoundingClientRect();
        return box.height && box.height < 38;
      }).map((one) => one.textContent));
    assert.deepEqual(small, [], `${tab}: too small for a finger`);
  }
  await show();
  const session = await context.newCDPSession(page);
  /** @param {{x: number, y: number}[]} way */
  const swipe = async (way) => {
    await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [way[0]] });
    for (const at of way.slice(1)) await session.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: [at] });
    await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    await frames();
  };
  const place = await page.locator(".place").first().boundingBox();
  assert.ok(place);
  const y = place.y + place.height - 12;
  const before = (await held("stage.view")).turn;
  await swipe([60, 90, 120, 150].map((x) => ({ x, y })));
  assert.notEqual((await held("stage.view")).turn, before);
  const handle = await page.locator(".handle").nth(7).boundingBox();
  assert.ok(handle);
  const value = (await held("app.state.cell.values"))[7];
  const [x, top] = [handle.x + handle.width / 2, handle.y + handle.height / 2];
  await swipe([0, 10, 20, 40].map((down) => ({ x, y: top + down })));
  assert.ok((await held("app.state.cell.values"))[7] < value);
});

test("without WebGL the contours and the gallery are shown, and the others say what they need", async () => {
  await close();
  await open({}, ["--disable-3d-apis"]);
  for (const tab of TABS) {
    await show(`#tab=${tab}`);
    const flat = ["gallery", "plane"].includes(tab);
    assert.equal(await page.locator(".banner").isVisible(), !flat, tab);
    assert.equal(await page.locator(".canvas").isVisible(), false, tab);
    assert.ok(!flat || (await page.locator(".sheet svg").count()) > 4, tab);
  }
  await follow("#tab=cell");
  assert.match((await page.locator(".banner").textContent()) ?? "", /draws no WebGL/);
  await follow("#tab=plane");
  assert.equal(await page.locator(".banner").isVisible(), false);
});
