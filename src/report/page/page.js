"use strict";
document.documentElement.classList.add("scripted");

// A click on a header sorts its table; another turns the order round. What is missing stays last.
function sort(header) {
  const table = header.closest("table"), rows = [...table.tBodies[0].rows], column = header.cellIndex;
  const descending = header.getAttribute("aria-sort") === "ascending";
  const key = row => row.cells[column].dataset.key;
  const numeric = rows.some(row => key(row) !== undefined);
  const compare = numeric
    ? (a, b) => (key(a) === undefined) - (key(b) === undefined)
      || (descending ? key(b) - key(a) : key(a) - key(b)) || 0
    : (a, b) => (descending ? -1 : 1)
      * a.cells[column].textContent.localeCompare(b.cells[column].textContent, "en", { numeric: true });
  for (const other of header.parentNode.cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", descending ? "descending" : "ascending");
  table.tBodies[0].append(...rows.sort(compare));
}
for (const header of document.querySelectorAll("thead th")) header.addEventListener("click", () => sort(header));

// A table that is wider than a screen is set smaller, and then with its numbers on two lines.
for (const box of document.querySelectorAll(".scroll:has(table)"))
  for (const step of ["tight", "tighter"])
    if (innerWidth > 720 && box.scrollWidth > box.clientWidth) box.classList.add(step);

// On a telephone a figure is enlarged by its button.
for (const drawing of document.querySelectorAll(".drawing")) {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", className: "enlarge", textContent: "Enlarge" });
  button.addEventListener("click", () => { button.textContent = drawing.classList.toggle("wide") ? "Fit" : "Enlarge"; });
  drawing.after(button);
}

// What is folded on the screen is printed.
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach(details => { details.open = true; }));
