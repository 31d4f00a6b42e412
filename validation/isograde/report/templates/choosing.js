// Sorts, filters and hides the rows of each table. Without it the page shows the first order whole.
"use strict";
document.body.classList.add("scripted");
for (const group of document.querySelectorAll(".group")) {
  const table = group.querySelector("table.choose");
  const form = group.querySelector(".filters");
  const heads = [...table.tHead.rows[0].cells];
  const rows = [...table.querySelectorAll("tbody tr[data-level]")];
  const hidden = new Set();

  // Each cell tells its heading, for narrow screens and for those who hear the page.
  for (const row of rows)
    [...row.cells].forEach((cell, at) => at && (cell.dataset.label = heads[at].textContent));

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
  }
  form.addEventListener("input", filter);
  form.addEventListener("submit", (event) => event.preventDefault());

  // Sort within each part: libraries stay apart from what is ours.
  heads.forEach((head, at) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const turn = down ? -1 : 1;
      const value = (row) => row.cells[at].dataset.value;
      const number = head.dataset.sort === "number" || at === 0;
      for (const body of table.tBodies) {
        const own = [...body.rows].filter((row) => row.dataset.level !== undefined);
        own.sort((a, b) =>
          number ? turn * (value(a) - value(b)) : turn * value(a).localeCompare(value(b)),
        );
        body.append(...own);
      }
    });
  });

  // Columns to pick, rows to hide.
  const box = form.querySelector(".columns > div");
  heads.forEach((head, at) => {
    if (!at) return;
    const label = document.createElement("label");
    const check = Object.assign(document.createElement("input"), { type: "checkbox", checked: true });
    label.append(check, head.textContent);
    box.append(label);
    check.addEventListener("input", () => {
      for (const row of [table.tHead.rows[0], ...rows]) row.cells[at].hidden = !check.checked;
    });
  });
  for (const row of rows) {
    const hide = Object.assign(document.createElement("button"), { type: "button", className: "hide", textContent: "hide" });
    hide.setAttribute("aria-label", `hide ${row.cells[0].firstChild.textContent}`);
    hide.addEventListener("click", () => {
      hidden.add(row);
      filter();
    });
    row.cells[0].append(hide);
  }
  filter();
}
