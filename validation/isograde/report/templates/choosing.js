// Sorts, filters and hides the rows of each table, refines the answers, opens what a link points at.
// Without it the page shows the first order whole.
"use strict";
document.body.classList.add("scripted");

/** An element with properties and children. */
function made(name, properties, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

for (const group of document.querySelectorAll(".group")) {
  const table = group.querySelector("table.choose");
  const form = group.querySelector(".filters");
  const heads = [...table.tHead.rows[0].cells];
  const rows = [...table.querySelectorAll("tbody tr[data-level]")];
  const hidden = new Set();

  function shown(row) {
    const { text, language, use, level, ties } = form.elements;
    return (
      !hidden.has(row) &&
      (!language.value || row.dataset.language === language.value) &&
      (!use.value || row.dataset.use === use.value) &&
      (!level.value || Number(row.dataset.level) >= Number(level.value)) &&
      (!ties.checked || row.dataset.ties === "1") &&
      (!text.value || row.textContent.toLowerCase().includes(text.value.toLowerCase()))
    );
  }
  function filter() {
    for (const row of rows) row.hidden = !shown(row);
    const left = rows.filter((row) => !row.hidden).length;
    form.querySelector("output").textContent = `${left} of ${rows.length} shown`;
    form.querySelector(".back").hidden = !hidden.size;
  }
  form.addEventListener("input", filter);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.querySelector(".back").addEventListener("click", () => {
    hidden.clear();
    filter();
  });

  // Sort within each part: libraries stay apart from what is ours.
  heads.forEach((head, at) => {
    const button = made("button", { type: "button" }, ...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const turn = down ? -1 : 1;
      const value = (row) => row.cells[at].dataset.value;
      const number = head.dataset.sort !== "text";
      for (const body of table.tBodies) {
        const own = [...body.rows].filter((row) => row.dataset.level !== undefined);
        own.sort((a, b) =>
          number ? turn * (value(a) - value(b)) : turn * value(a).localeCompare(value(b)),
        );
        body.append(...own);
      }
    });
  });

  // Columns to pick; some are left aside until they are asked for.
  const box = form.querySelector(".columns > div");
  heads.forEach((head, at) => {
    if (!at) return;
    const check = made("input", { type: "checkbox", checked: head.dataset.aside === undefined });
    box.append(made("label", {}, check, head.textContent));
    const show = () => {
      for (const row of [table.tHead.rows[0], ...rows]) row.cells[at].hidden = !check.checked;
    };
    check.addEventListener("input", show);
    show();
  });
  for (const row of rows) {
    const hide = made("button", { type: "button", className: "hide", textContent: "hide" });
    hide.setAttribute("aria-label", `hide ${row.dataset.name}`);
    hide.addEventListener("click", () => {
      hidden.add(row);
      filter();
      // The keyboard goes on at the next row that is shown, or at what shows the hidden ones.
      let next = row;
      while (next?.hidden) next = next.nextElementSibling;
      const at = next?.querySelector(".hide") ?? form.querySelector(".back");
      at.focus({ preventScroll: true });
    });
    row.cells[0].append(hide);
  }
  filter();

  // The answers to a need can be narrowed by language and licence.
  for (const answer of group.querySelectorAll(".answer")) {
    const items = [...answer.querySelectorAll("li")];
    if (!items.length) continue;
    const of = (item) => rows.find((row) => row.dataset.name === item.dataset.name).dataset;
    const chosen = ["language", "use"].map((word) => {
      const words = [...new Set(items.map((item) => of(item)[word]))].filter(Boolean).sort();
      const select = made("select", {}, ...["any", ...words].map((one) => made("option", { textContent: one })));
      return { word, words, select };
    });
    const all = made("button", { type: "button", className: "hide" });
    let whole = false;
    const narrow = () => {
      let left = 0;
      for (const item of items) {
        const fits = chosen.every(({ word, select }) => select.value === "any" || of(item)[word] === select.value);
        left += fits;
        item.hidden = !fits || (!whole && left > 5);
      }
      all.hidden = left <= 5;
      all.textContent = whole ? "the first five" : `all ${left}`;
    };
    all.addEventListener("click", () => {
      whole = !whole;
      narrow();
    });
    const told = { language: "language", use: "licence" };
    const labels = chosen.filter(({ words }) => words.length > 1);
    const choices = labels.map(({ word, select }) => made("label", {}, told[word], select));
    const bar = made("div", { className: "refine" }, ...choices);
    bar.addEventListener("input", narrow);
    answer.insertBefore(bar, answer.querySelector("ol"));
    answer.append(all);
    narrow();
  }
}

// Each cell tells its heading, for narrow screens and for those who hear the page.
for (const table of document.querySelectorAll("table")) {
  const heads = [...(table.tHead?.rows[0].cells ?? [])].map((head) => head.textContent.trim());
  for (const body of table.tBodies)
    for (const row of body.rows)
      if (row.cells.length === heads.length)
        [...row.cells].forEach((cell, at) => at && (cell.dataset.label = heads[at]));
}

// What a link points at is opened; on paper everything is.
function open() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let at = target; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  if (target) target.scrollIntoView();
}
addEventListener("hashchange", open);
open();
const undo = [];
addEventListener("beforeprint", () => {
  for (const one of document.querySelectorAll(".need[name]")) {
    one.removeAttribute("name");
    undo.push(() => one.setAttribute("name", "need"));
  }
  for (const one of document.querySelectorAll("details:not(.columns):not([open])")) {
    one.open = true;
    undo.push(() => (one.open = false));
  }
  for (const one of document.querySelectorAll(".answer li[hidden]")) {
    one.hidden = false;
    undo.push(() => (one.hidden = true));
  }
});
addEventListener("afterprint", () => {
  while (undo.length) undo.pop()();
});
