// Tables that sort by a click on their headings, and files that can be saved. Needs nothing else.
const $ = (selector, within = document) => within.querySelector(selector);
const $$ = (selector, within = document) => [...within.querySelectorAll(selector)];

document.documentElement.classList.add("scripts");

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const PREFIXES = { y: 1e-24, z: 1e-21, a: 1e-18, f: 1e-15, p: 1e-12, n: 1e-9, "µ": 1e-6, m: 1e-3, k: 1e3, M: 1e6, G: 1e9 };

// The number that a cell begins with, in the unit without prefix ("25.4 ms" is 0.0254), or NaN.
function numberIn(text) {
  const match = text.trim().replace(/−/g, "-").match(/^([-+]?\d[\d.]*(?:e[-+]?\d+)?)(?: (\S+))?/);
  if (!match) return NaN;
  const unit = match[2] || "";
  const scaled = unit.length > 1 && /^[yzafpnµmkMG](s|m|N|J|W|N·m)$/.test(unit);
  return parseFloat(match[1]) * (scaled ? PREFIXES[unit[0]] : 1);
}

function sortBy(table, column, down) {
  const body = table.tBodies[0];
  const keyed = [...body.rows].map((row) => {
    const text = row.cells[column] ? row.cells[column].textContent : "";
    return { row, text, number: numberIn(text) };
  });
  const numeric = keyed.filter((cell) => !isNaN(cell.number)).length >= keyed.length / 2;
  keyed.sort((a, b) => {
    if (numeric && isNaN(a.number) !== isNaN(b.number)) return isNaN(a.number) ? 1 : -1; // cells without a number come last
    const order = numeric && !isNaN(a.number) ? a.number - b.number : a.text.localeCompare(b.text);
    return down ? -order : order;
  });
  body.append(...keyed.map((cell) => cell.row));
}

for (const table of $$("table")) {
  if (!table.tHead || !table.tBodies[0] || table.tBodies[0].rows.length < 3) continue;
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    if (!head.textContent.trim()) return;
    const button = make("button", { type: "button", class: "sort" }, ...head.childNodes);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      sortBy(table, column, down);
    });
    head.append(button);
  });
}

function save(name, content, type = "text/plain") {
  const link = make("a", { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Buttons that save files; content: a text, or a function that makes it.
function offer(files) {
  const place = $("#files");
  if (!files.length) {
    for (const element of [place.closest("section"), $("a[href='#save']").closest("li")]) element.remove();
  }
  for (const [name, content] of files) {
    const button = make("button", { type: "button" }, name);
    button.addEventListener("click", () => save(name, typeof content === "function" ? content() : content));
    place.append(button);
  }
}

const data = $("#page-data") ? JSON.parse($("#page-data").textContent) : {};
