// The page: what is shown, and how it answers to mouse, touch and keys.

const given = JSON.parse(document.getElementById("data").textContent);
const part = (id) => document.getElementById(id);
const canvas = part("grid"), marks = part("mark"), view = new View();
const grid = { blocks: [], boundaries: given.boundaries, nameBoxes: [] };
const options = { measure: null, range: [0, 1], colors: null, lines: true, names: given.named, coarse: false, ratio: 1, style: {} };
let chosen = null, kept = false, extent = null, due = 0, refine = 0;

/** Return a number as text: as many digits as are known to be right. */
function shown(value, unit = "", digits = unit ? 5 : 6) {
  if (Number.isNaN(value)) return "none";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  return `${Number(value.toPrecision(digits))}${unit}`.replace("-", "−").replace("e-", "e−");
}

/** Return the indices of a cell, or of the cells that one of a thinned grid stands for. */
function indices({ block, i, j }) {
  const range = (index, axis) => {
    const from = index * block.steps[axis], to = Math.min(from + block.steps[axis], block.full[axis] - 1) - 1;
    return from === to ? `${from}` : `${from}–${to}`;
  };
  return `(${range(i, 0)}, ${range(j, 1)})`;
}

/** Return coordinates as text, with so many digits that neighboring cells have other ones. */
function place(point, size) {
  const most = Math.max(...point.map(Math.abs)), digits = Math.ceil(Math.log10(most / size)) + 4;
  return point.map((one) => shown(one, "", Math.min(Math.max(6, digits || 6), 16))).join(", ");
}

/** Return the rows that describe a cell: words, value, whether it is an alarm. */
function describe(cell) {
  const { block, i, j } = cell, number = i * (block.nj - 1) + j, found = measured(block, i, j);
  const k = i * block.nj + j, nodes = [k, k + 1, k + block.nj, k + block.nj + 1];
  const mean = (plane) => nodes.reduce((sum, node) => sum + plane[node] / 4, 0);
  const size = Math.hypot(block.x[nodes[3]] - block.x[k], block.y[nodes[3]] - block.y[k]);
  const rows = [
    ["center", place([mean(block.x), mean(block.y)], size)],
    ["J, smallest", shown(found.jacobian), !(found.jacobian > 0)],
    ["scaled Jacobian", shown(found.scaled), !(found.scaled > 0)],
    ["angles", `${shown(found.smallest, "°")} to ${shown(found.largest, "°")}`],
    ["degrees off 90", shown(found.off, "°")],
    ["area", shown(found.area)],
    ["aspect ratio", shown(found.aspect)],
    ["condition", shown(found.condition)],
    ["neighbors' area ratio", shown(block.values.growth[number])],
  ];
  if (block.field) rows.push([given.field, shown(block.values.field[number])]);
  if (block.folded[number]) rows.unshift(["folded", "J ≤ 0 at a corner", true]);
  return rows;
}

/** Return the name of a cell. */
function nameOf(cell) {
  return `${given.named ? `block ${cell.block.name}, ` : ""}cell ${indices(cell)}`;
}

/** Choose a cell, or none; speak it to those who listen. */
function choose(cell, aloud = false) {
  chosen = cell;
  const body = part("cell").tBodies[0];
  body.replaceChildren();
  part("cell-name").textContent = cell ? `${nameOf(cell)}${kept ? ", kept" : ""}` : "Point at a cell";
  const rows = cell ? describe(cell) : [];
  for (const [words, value, alarm] of rows) {
    const row = body.insertRow(), head = document.createElement("th");
    head.scope = "row";
    head.textContent = words;
    row.append(head);
    const entry = row.insertCell();
    entry.textContent = value;
    if (alarm) entry.className = "alarm";
  }
  if (aloud) part("spoken").textContent = cell ? `${nameOf(cell)}: ${rows.map(([words, value]) => `${words} ${value}`).join("; ")}` : "no cell";
  drawMark(marks, view, chosen, options);
}

/** Draw soon: coarsely while something moves, and finely after it. */
function redraw(moving = false) {
  if (moving) {
    options.coarse = true;
    clearTimeout(refine);
    refine = setTimeout(() => { options.coarse = false; redraw(); }, 150);
  }
  due ||= requestAnimationFrame(() => {
    due = 0;
    canvas.dataset.cells = drawGrid(canvas, view, grid, options);
    canvas.dataset.names = JSON.stringify(grid.nameBoxes);
    drawMark(marks, view, chosen, options);
    canvas.dataset.drawn = Number(canvas.dataset.drawn ?? 0) + 1;
  });
}

/** Take the size of the window and the colors of its mode. */
function fit() {
  options.ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect(), old = view.width;
  for (const one of [canvas, marks]) {
    one.width = Math.max(1, Math.round(width * options.ratio));
    one.height = Math.max(1, Math.round(height * options.ratio));
  }
  const factor = old > 1 ? canvas.width / old : 1;
  Object.assign(view, { width: canvas.width, height: canvas.height, scale: view.scale * factor });
  const style = getComputedStyle(document.documentElement);
  for (const name of ["paper", "ink", "line", "edge", "folded"]) options.style[name] = style.getPropertyValue(`--${name}`).trim();
  redraw();
}

/** Color by a measure. */
function color(id) {
  const measure = measures().find((one) => one.id === id);
  options.measure = measure;
  part("worst").disabled = !MEASURES.includes(measure);
  part("scale").hidden = id === "none";
  if (id !== "none") {
    const colors = id === "field" ? LOW_TO_HIGH : GOOD_TO_BAD;
    options.range = rangeOf(measure, grid.blocks);
    options.colors = shades(colors);
    part("bar").style.background = `linear-gradient(to right, ${(measure.low ? [...colors].reverse() : colors).join(", ")})`;
    part("low").textContent = shown(options.range[0], measure.unit);
    part("high").textContent = shown(options.range[1], measure.unit);
    part("scale").setAttribute("aria-label", `${measure.label}: ${part("low").textContent} to ${part("high").textContent}`);
  }
  redraw();
}

/** Return what colors may show. */
function measures() {
  const field = given.field ? [{ id: "field", label: given.field }] : [];
  return [...MEASURES, ...field, { id: "none", label: "none" }];
}

/** Show a cell with some of its neighbors, and keep it. */
function goTo(cell) {
  const { block, i, j } = cell, box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
  for (const p of [i, i + 1]) {
    for (const q of [j, j + 1]) {
      const k = p * block.nj + q;
      box.left = Math.min(box.left, block.x[k]);
      box.right = Math.max(box.right, block.x[k]);
      box.low = Math.min(box.low, block.y[k]);
      box.high = Math.max(box.high, block.y[k]);
    }
  }
  if (box.right > box.left || box.high > box.low) view.show(box, 0.25);
  kept = true;
  choose(cell, true);
  redraw();
}

/** Choose the neighbor of the chosen cell, so many cells further along i and j. */
function step(alongI, alongJ) {
  if (!chosen) return;
  const { block } = chosen, i = chosen.i + alongI, j = chosen.j + alongJ;
  if (i < 0 || j < 0 || i >= block.ni - 1 || j >= block.nj - 1) return;
  kept = true;
  choose({ block, i, j }, true);
}

/** Return the pixel of the canvas under a pointer. */
function pixel(event) {
  const box = canvas.getBoundingClientRect();
  return [(event.clientX - box.left) * options.ratio, (event.clientY - box.top) * options.ratio];
}

/** Listen to mouse and touch: one pointer pans, two zoom, a click keeps a cell. */
function listenToPointers() {
  const pointers = new Map();
  let travelled = 0;
  const middle = () => {
    const all = [...pointers.values()], mean = (k) => all.reduce((sum, one) => sum + one[k], 0) / all.length;
    const spread = all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 0;
    return [mean(0), mean(1), spread];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, pixel(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const [px, py] = pixel(event);
    if (!pointers.has(event.pointerId)) {
      if (!kept) choose(cellsAt(grid.blocks, ...view.at(px, py))[0] ?? null);
      return;
    }
    const [x, y, spread] = middle();
    pointers.set(event.pointerId, [px, py]);
    const [toX, toY, toSpread] = middle();
    travelled += Math.abs(toX - x) + Math.abs(toY - y) + Math.abs(toSpread - spread);
    view.x -= (toX - x) / view.scale;
    view.y += (toY - y) / view.scale;
    if (spread > 0 && toSpread > 0) view.zoom(toSpread / spread, toX, toY);
    redraw(true);
  });
  const lift = (event) => {
    const clicked = pointers.delete(event.pointerId) && pointers.size === 0 && travelled < 4 * options.ratio;
    if (!clicked || event.type === "pointercancel") return;
    const cell = cellsAt(grid.blocks, ...view.at(...pixel(event)))[0] ?? null;
    kept = cell !== null && !(kept && chosen && cell.block === chosen.block && cell.i === chosen.i && cell.j === chosen.j);
    choose(cell, true);
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("pointerleave", () => { if (!kept && pointers.size === 0) choose(null); });
  canvas.addEventListener("wheel", (event) => {
    // In a frame of another page the wheel scrolls that page, until the grid has been clicked.
    if (window !== window.parent && document.activeElement !== canvas) return;
    event.preventDefault();
    view.zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), ...pixel(event));
    redraw(true);
  }, { passive: false });
}

/** Listen to keys, when the grid has the focus. */
function listenToKeys() {
  const pan = (right, up) => {
    view.x += (right * view.width) / (10 * view.scale);
    view.y += (up * view.height) / (10 * view.scale);
    redraw(true);
  };
  const acts = {
    ArrowLeft: () => pan(-1, 0), ArrowRight: () => pan(1, 0), ArrowUp: () => pan(0, 1), ArrowDown: () => pan(0, -1),
    "+": () => zoomBy(1.5), "=": () => zoomBy(1.5), "-": () => zoomBy(1 / 1.5), 0: whole, Home: whole,
    i: () => step(1, 0), I: () => step(-1, 0), j: () => step(0, 1), J: () => step(0, -1),
    w: worst,
    c: () => {
      const cell = cellsAt(grid.blocks, view.x, view.y)[0] ?? null;
      kept = cell !== null;
      choose(cell, true);
    },
    Escape: () => { kept = false; choose(null, true); },
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !Object.hasOwn(acts, event.key)) return;
    event.preventDefault();
    acts[event.key]();
  });
}

function zoomBy(factor) {
  view.zoom(factor);
  redraw(true);
}

function whole() {
  view.show(extent);
  redraw();
}

function worst() {
  if (MEASURES.includes(options.measure)) goTo(worstCell(options.measure, grid.blocks));
}

/** Write what the picture's lines and colors mean. */
function explain() {
  const count = given.folded, kinds = given.boundaries.map(({ name, color: stroke, dash }) => [name, stroke, dash]);
  if (count > 0) kinds.unshift([`${count} folded cell${count > 1 ? "s" : ""}`, "var(--folded)", null]);
  for (const [words, stroke, dash] of kinds) {
    const entry = document.createElement("li"), picture = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
    picture.setAttribute("viewBox", "0 0 24 11");
    picture.setAttribute("aria-hidden", "true");
    Object.entries({ x1: 1, y1: 5.5, x2: 23, y2: 5.5 }).forEach(([key, value]) => line.setAttribute(key, value));
    line.style.stroke = stroke;
    line.style.strokeWidth = dash ? 3 : 11;
    if (dash) line.style.strokeDasharray = dash.map((length) => 3 * length).join(" ");
    picture.append(line);
    entry.append(picture, words);
    part("kinds").append(entry);
  }
}

/** Begin: decode the blocks, measure them, and show the whole. */
async function begin() {
  part("names-label").hidden = !given.named;
  document.querySelector("header").hidden = window !== window.parent;  // A notebook has it above.
  for (const one of given.blocks) {
    const block = await unpackBlock(one);
    block.middle = one.middle;
    measureBlock(block);
    cutIntoTiles(block);
    grid.blocks.push(block);
  }
  const tiles = grid.blocks.flatMap((block) => block.tiles);
  extent = {
    left: Math.min(...tiles.map((one) => one.left)), right: Math.max(...tiles.map((one) => one.right)),
    low: Math.min(...tiles.map((one) => one.low)), high: Math.max(...tiles.map((one) => one.high)),
  };
  for (const { id, label } of measures()) part("measure").add(new Option(label, id));
  explain();
  fit();
  whole();
  color(given.field ? "field" : "scaled");
  part("measure").value = options.measure.id;
  part("measure").addEventListener("change", (event) => color(event.target.value));
  part("lines").addEventListener("change", (event) => { options.lines = event.target.checked; redraw(); });
  part("names").addEventListener("change", (event) => { options.names = event.target.checked; redraw(); });
  part("in").addEventListener("click", () => zoomBy(1.5));
  part("out").addEventListener("click", () => zoomBy(1 / 1.5));
  part("whole").addEventListener("click", whole);
  part("worst").addEventListener("click", worst);
  listenToPointers();
  listenToKeys();
  new ResizeObserver(fit).observe(part("stage"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", fit);
  // For scripts that drive the page: where a point is, and what is chosen.
  window.gridView = { view, grid, options, pixelOf: (x, y) => [view.px(x) / options.ratio, view.py(y) / options.ratio], chosen: () => chosen };
  document.documentElement.dataset.ready = "true";
}

begin().catch((error) => {
  part("note").textContent = `This page cannot be shown: ${error.message}. It needs a browser of 2023 or later.`;
  throw error;
});
