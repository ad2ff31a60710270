// The table of encounters: sorting by the headings, filtering, and opening of a replay.
const table = document.getElementById("encounter-table");
const body = table.tBodies[0];
const filters = {
  text: document.getElementById("filter-text"),
  controller: document.getElementById("filter-controller"),
  scenario: document.getElementById("filter-scenario"),
  severity: document.getElementById("filter-severity"),
};

function sortBy(heading, index, kind) {
  const descending = heading.getAttribute("aria-sort") === "ascending";
  for (const other of table.tHead.rows[0].cells) {
    if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
  }
  heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
  const sign = descending ? -1 : 1;
  const value = (row) => row.cells[index].dataset.v;
  const rows = Array.from(body.rows);
  rows.sort((a, b) => {
    const [one, other] = [value(a), value(b)];
    if (one === "" || other === "") return (one === "") - (other === ""); // what is undefined comes last
    if (kind === "num") return sign * (Number(one) - Number(other));
    return sign * one.localeCompare(other, "en", { numeric: true });
  });
  body.append(...rows);
}

Array.from(table.tHead.rows[0].cells).forEach((heading, index) => {
  const button = heading.querySelector("button");
  if (button) button.addEventListener("click", () => sortBy(heading, index, button.dataset.kind));
});

function applyFilters() {
  const words = filters.text.value.toLowerCase().split(/\s+/).filter(Boolean);
  let shown = 0;
  for (const row of body.rows) {
    const text = (row.textContent + " seed " + row.cells[9].textContent).toLowerCase();
    const keep =
      words.every((word) => text.includes(word)) &&
      ["controller", "scenario", "severity"].every(
        (name) => filters[name].value === "" || filters[name].value === row.dataset[name],
      );
    row.hidden = !keep;
    shown += keep ? 1 : 0;
  }
  document.getElementById("filter-count").textContent = `${shown} shown`;
}

for (const field of Object.values(filters)) field.addEventListener("input", applyFilters);
document.getElementById("filters").addEventListener("submit", (event) => event.preventDefault());

body.addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (!button) return;
  const row = button.closest("tr");
  if (button.classList.contains("open")) openReplay(row);
  if (button.classList.contains("how")) {
    const where = document.getElementById("record-" + row.dataset.run);
    where.tabIndex = -1;
    where.scrollIntoView({ block: "center" });
    where.focus();
  }
});

// Rows of the table as it is sorted and filtered now, with a replay.
function replayableRows() {
  return Array.from(body.rows).filter((row) => !row.hidden && row.querySelector("button.open"));
}

applyFilters(); // a browser may have kept the fields of an earlier visit
function openLinked() {
  if (!location.hash.startsWith("#replay=")) return;
  const key = decodeURIComponent(location.hash.slice("#replay=".length));
  const row = Array.from(body.rows).find((one) => one.dataset.key === key);
  if (row && row.querySelector("button.open")) openReplay(row);
  // A verdict on an ego that met nobody has its replay without a row of the table.
  const moment = Array.from(document.querySelectorAll("a.open-moment")).find((one) => one.dataset.key === key);
  if (moment) openReplay(moment);
}
openLinked();
window.addEventListener("hashchange", openLinked);

// Printed are the first rows as they are sorted and filtered now; the line below the table counts the others.
window.addEventListener("beforeprint", () => {
  const shown = Array.from(body.rows).filter((row) => !row.hidden);
  shown.forEach((row, i) => row.classList.toggle("unprinted", i >= PRINTED));
  const leftOut = document.getElementById("encounters-left-out");
  const count = TOTAL - Math.min(shown.length, PRINTED);
  leftOut.firstElementChild.textContent = String(count);
  leftOut.classList.toggle("unprinted", count === 0);
});

// What is folded up is printed, but for the appendix; afterwards it is as it was.
const folded = document.querySelectorAll("#configurations details:not([open]), #comparisons details:not([open])");
window.addEventListener("beforeprint", () => folded.forEach((one) => (one.open = true)));
window.addEventListener("afterprint", () => folded.forEach((one) => (one.open = false)));
