// The picture: filled cells, grid lines, edges of blocks, names.

/** What is shown: the center in the unit of the grid, and pixels per unit. */
class View {
  constructor() {
    Object.assign(this, { x: 0, y: 0, scale: 1, width: 1, height: 1 });
  }
  px(x) { return (x - this.x) * this.scale + this.width / 2; }
  py(y) { return (this.y - y) * this.scale + this.height / 2; }
  /** The point of the grid's plane at a pixel. */
  at(px, py) { return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale]; }
  box() {
    const [left, high] = this.at(0, 0), [right, low] = this.at(this.width, this.height);
    return { left, right, low, high };
  }
  /** Show a box, with a margin. */
  show(box, fraction = 0.92) {
    this.x = (box.left + box.right) / 2;
    this.y = (box.low + box.high) / 2;
    const wide = box.right - box.left, high = box.high - box.low;
    const scale = fraction * Math.min(this.width / (wide || high || 1), this.height / (high || wide || 1));
    this.scale = Math.min(Math.max(scale, 1e-304), 1e304);
  }
  /** Zoom about a pixel, which stays at its point. */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.at(px, py), scale = this.scale * factor;
    const finest = Math.max(Math.abs(x), Math.abs(y)) * 1e-14;  // Beyond, doubles cannot tell pixels apart.
    if (!(scale > 1e-304 && scale < 1e304) || (factor > 1 && scale * finest > 1)) return;
    this.scale = scale;
    this.x = x - (px - this.width / 2) / scale;
    this.y = y + (py - this.height / 2) / scale;
  }
}

/** So many steps from lines that are hidden, 3 pixels from each other, to those that are drawn fully. */
const FADES = 4;
/** Of more folded cells the lines are hardly seen. */
const MOST_REDDENED = 5000;

/** Draw everything on a canvas; returns how many cells were painted. */
function drawGrid(canvas, view, grid, options) {
  const context = canvas.getContext("2d"), { width, height } = canvas, ratio = options.ratio;
  const data = context.createImageData(width, height);
  const image = { pixels: new Uint32Array(data.data.buffer), width, height };
  const box = view.box(), shown = [], folded = [];
  const plain = options.measure.id === "none";
  let apart = (options.coarse ? 8 : plain ? 4 : 3) * ratio / view.scale, count;
  do {  // Fewer lines, until they can be drawn at once.
    shown.length = count = 0;
    for (const block of grid.blocks) {
      for (const tile of block.tiles) {
        if (!meets(tile, box)) continue;
        const lines = linesOf(block, tile, apart);
        shown.push({ block, tile, lines });
        count += (lines.i.length - 1) * (lines.j.length - 1);
      }
    }
    apart *= 1.5;
  } while (count > (options.coarse ? 60000 : 400000) && apart * view.scale < 200 * ratio);
  for (const { block, tile, lines } of shown) {
    paintTile(image, view, block, tile, lines, options.measure, options.range, options.colors, folded);
  }
  closeHoles(image);
  paintFolded(image, folded, packed(channels(options.style.folded)), Math.round(3 * ratio));
  context.putImageData(data, 0, 0);
  if (options.lines || plain) drawLines(context, view, shown, options, plain);
  redden(context, folded, options.style.folded);
  drawEdges(context, view, grid, options);
  if (options.names) drawNames(context, view, grid, options);
  return count;
}

/** Draw the lines of tiles; over colors they fade where they are too close for the colors to be seen. */
function drawLines(context, view, shown, { style, ratio }, plain) {
  const paths = Array.from({ length: FADES + 1 }, () => new Path2D());
  for (const { block, tile, lines } of shown) {
    const { nj } = block, { i: rows, j: columns } = lines;
    // The last line of a tile is the first of the next one, or the edge of the block. Over colors, lines show cells:
    // where some are left out, the others are, too.
    rows.forEach((i, p) => {
      if (i === 0 || i === tile.i1 || (!plain && rows[p + 1] > i + 1)) return;
      fade(paths, view, block, columns.map((j) => i * nj + j), (rows[p + 1] - i) * nj, ratio, plain);
    });
    columns.forEach((j, q) => {
      if (j === 0 || j === tile.j1 || (!plain && columns[q + 1] > j + 1)) return;
      fade(paths, view, block, rows.map((i) => i * nj + j), columns[q + 1] - j, ratio, plain);
    });
  }
  context.strokeStyle = plain ? style.edge : style.line;
  context.lineWidth = (plain ? 0.6 : 0.8) * ratio;
  for (let level = 1; level <= FADES; level++) {
    context.globalAlpha = level / FADES;
    context.stroke(paths[level]);
  }
  context.globalAlpha = 1;
}

/** Fill folded cells once more, where lines have covered their red. */
function redden(context, folded, color) {
  const path = new Path2D();
  for (let k = 0; k < folded.length && k < 8 * MOST_REDDENED; k += 8) {
    path.moveTo(folded[k], folded[k + 1]);
    for (let n = 2; n < 8; n += 2) path.lineTo(folded[k + n], folded[k + n + 1]);
    path.closePath();
  }
  context.fillStyle = color;
  context.globalAlpha = 0.6;
  context.fill(path);
  context.globalAlpha = 1;
}

/** Add the segments of a line to the paths, by how far the next line is: its nodes are `ahead` of these. */
function fade(paths, view, block, nodes, ahead, ratio, plain) {
  const { x, y } = block;
  for (let n = 1; n < nodes.length; n++) {
    const k = nodes[n], gap = Math.hypot(x[k + ahead] - x[k], y[k + ahead] - y[k]) * view.scale / ratio;
    const level = plain ? FADES : Math.min(FADES, Math.floor((gap - 1) / 2));
    if (level >= 1) trace(paths[level], view, block, [nodes[n - 1], k]);
  }
}

/** Add a line through nodes to a path or context; what is far outside is left out, since browsers draw it wrongly. */
function trace(path, view, block, nodes) {
  const reach = 4 * (view.width + view.height);
  let before = null;
  for (const k of nodes) {
    const here = [view.px(block.x[k]), view.py(block.y[k])];
    if (before) segment(path, before, here, reach);
    before = here;
  }
}

/** Add a segment to the path, cut to the box that reaches so far from the origin. */
function segment(path, [ax, ay], [bx, by], reach) {
  let from = 0, to = 1;
  for (const [start, step] of [[ax, bx - ax], [ay, by - ay]]) {
    if (step === 0 && Math.abs(start) > reach) return;
    if (step === 0) continue;
    const one = (-reach - start) / step, other = (reach - start) / step;
    from = Math.max(from, Math.min(one, other));
    to = Math.min(to, Math.max(one, other));
  }
  if (from > to) return;
  path.moveTo(ax + from * (bx - ax), ay + from * (by - ay));
  path.lineTo(ax + to * (bx - ax), ay + to * (by - ay));
}

/** Return the nodes of a part of a side that are more than half a pixel from the one before. */
function nodesOfPart(block, side, first, last, view) {
  const { ni, nj, x, y } = block, nodes = [];
  const node = { bottom: (m) => m * nj, top: (m) => m * nj + nj - 1, left: (m) => m, right: (m) => (ni - 1) * nj + m }[side];
  for (let m = first; m <= last; m++) {
    const k = node(m), before = nodes.at(-1);
    const near = before !== undefined && Math.hypot(x[k] - x[before], y[k] - y[before]) * view.scale < 0.5;
    if (!near || m === last) nodes.push(k);
  }
  return nodes;
}

/** Draw the sides of blocks, and named boundaries in their colors over them. */
function drawEdges(context, view, grid, { style, ratio }) {
  context.lineJoin = context.lineCap = "round";
  context.strokeStyle = style.edge;
  context.lineWidth = 1.6 * ratio;
  context.beginPath();
  for (const block of grid.blocks) {
    for (const [side, last] of [["bottom", block.ni - 1], ["right", block.nj - 1], ["top", block.ni - 1], ["left", block.nj - 1]]) {
      trace(context, view, block, nodesOfPart(block, side, 0, last, view));
    }
  }
  context.stroke();
  context.lineWidth = 3 * ratio;
  for (const { color, dash, parts } of grid.boundaries) {
    context.strokeStyle = color;
    context.setLineDash(dash.map((length) => length * 3 * ratio));
    context.beginPath();
    for (const [number, side, first, last] of parts) {
      trace(context, view, grid.blocks[number], nodesOfPart(grid.blocks[number], side, first, last, view));
    }
    context.stroke();
  }
  context.setLineDash([]);
}

/** Write the names of blocks at their middles, none over another. */
function drawNames(context, view, grid, { style, ratio }) {
  const taken = [];
  context.font = `600 ${13 * ratio}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const block of grid.blocks) {
    const px = view.px(block.middle[0]), py = view.py(block.middle[1]);
    const half = context.measureText(block.name).width / 2 + 5 * ratio, tall = 10 * ratio;
    const box = { left: px - half, right: px + half, low: py - tall, high: py + tall };
    if (taken.some((other) => meets(other, box)) || px < 0 || py < 0 || px > view.width || py > view.height) continue;
    taken.push(box);
    context.fillStyle = style.paper;
    context.globalAlpha = 0.85;
    context.beginPath();
    context.roundRect(box.left, box.low, 2 * half, 2 * tall, 4 * ratio);
    context.fill();
    context.globalAlpha = 1;
    context.fillStyle = style.ink;
    context.fillText(block.name, px, py);
  }
  grid.nameBoxes = taken;
}

/** Outline a cell on the canvas over the picture. */
function drawMark(canvas, view, cell, { ratio, style }) {
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  if (!cell) return;
  const { block, i, j } = cell, k = i * block.nj + j, nodes = [k, k + block.nj, k + block.nj + 1, k + 1, k];
  context.lineJoin = "round";
  for (const [color, wide] of [[style.paper, 5], [style.ink, 2]]) {
    context.strokeStyle = color;
    context.lineWidth = wide * ratio;
    context.beginPath();
    trace(context, view, block, nodes);
    context.stroke();
  }
  const px = nodes.map((node) => view.px(block.x[node])), py = nodes.map((node) => view.py(block.y[node]));
  const wide = Math.max(...px) - Math.min(...px), high = Math.max(...py) - Math.min(...py);
  if (Math.max(wide, high) >= 8 * ratio) return;
  context.strokeStyle = style.ink;  // A ring around what is too small to be seen.
  context.beginPath();
  context.arc(px[0], py[0], 9 * ratio, 0, 2 * Math.PI);
  context.stroke();
}
