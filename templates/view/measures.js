// Measures of a cell, as gridgen_sym.Quality defines them: the worst of its four corners.

const DEGREES = 180 / Math.PI;
/** Measures of each cell: the words, whether small is bad, whether colors go by the logarithm, and the range if fixed. */
const MEASURES = [
  { id: "scaled", label: "scaled Jacobian", low: true, range: [0, 1] },
  { id: "jacobian", label: "Jacobian J", low: true, log: true },
  { id: "smallest", label: "smallest angle", low: true, range: [0, 90], unit: "°" },
  { id: "largest", label: "largest angle", range: [90, 180], unit: "°" },
  { id: "off", label: "degrees off 90", range: [0, 90], unit: "°" },
  { id: "aspect", label: "aspect ratio", log: true },
  { id: "condition", label: "condition", log: true },
  { id: "growth", label: "neighbors' area ratio", log: true },
];

/** Return all measures of cell (i, j) of a block, by their ids, and its area. */
function measured(block, i, j) {
  const { x, y, nj } = block, k = i * nj + j, a = k, b = k + nj, c = k + nj + 1, d = k + 1;
  // Edges along xi at the bottom and the top, along eta at the left and the right.
  const bx = x[b] - x[a], by = y[b] - y[a], tx = x[c] - x[d], ty = y[c] - y[d];
  const lx = x[d] - x[a], ly = y[d] - y[a], rx = x[c] - x[b], ry = y[c] - y[b];
  const found = { jacobian: Infinity, scaled: Infinity, smallest: 360, largest: 0, off: 0, condition: 0, area: 0 };
  corner(found, bx, by, lx, ly, false);
  corner(found, bx, by, rx, ry, true);
  corner(found, tx, ty, rx, ry, false);
  corner(found, tx, ty, lx, ly, true);
  const wide = Math.sqrt(bx * bx + by * by) + Math.sqrt(tx * tx + ty * ty);
  const high = Math.sqrt(lx * lx + ly * ly) + Math.sqrt(rx * rx + ry * ry);
  const small = Math.min(wide, high);
  found.aspect = small > 0 ? Math.max(wide, high) / small : Infinity;
  return found;
}

/** Count a corner with the edge vectors g1 and g2; at a turned one, one of them points into the corner. */
function corner(found, px, py, qx, qy, turned) {
  const J = px * qy - py * qx, dot = px * qx + py * qy, g11 = px * px + py * py, g22 = qx * qx + qy * qy;
  const product = Math.sqrt(g11) * Math.sqrt(g22);
  let angle = product > 0 ? Math.atan2(J, turned ? -dot : dot) * DEGREES : 0;
  if (angle < 0) angle += 360;
  const off = product > 0 ? Math.atan2(Math.abs(dot), Math.abs(J)) * DEGREES : 90;
  found.area += J / 4;
  found.jacobian = Math.min(found.jacobian, J);
  found.scaled = Math.min(found.scaled, product > 0 ? J / product : 0);
  found.smallest = Math.min(found.smallest, angle);
  found.largest = Math.max(found.largest, angle);
  found.off = Math.max(found.off, off);
  found.condition = Math.max(found.condition, J > 0 ? (g11 + g22) / J : Infinity);
}

/** Return the largest ratio of the areas of a cell and its neighbors in its block. */
function growth(block, i, j) {
  const { areas } = block, rows = block.ni - 1, columns = block.nj - 1, here = areas[i * columns + j];
  let most = 1;
  for (const [p, q] of [[i - 1, j], [i + 1, j], [i, j - 1], [i, j + 1]]) {
    if (p < 0 || q < 0 || p >= rows || q >= columns) continue;
    const there = areas[p * columns + q], small = Math.min(here, there);
    most = Math.max(most, small > 0 ? Math.max(here, there) / small : Infinity);
  }
  return most;
}

/** Give a block the arrays of its measures, one value for each cell. */
function measureBlock(block) {
  const rows = block.ni - 1, columns = block.nj - 1;
  block.values = Object.fromEntries(MEASURES.map((measure) => [measure.id, new Float64Array(rows * columns)]));
  block.areas = new Float64Array(rows * columns);
  const ids = MEASURES.map((measure) => measure.id).filter((id) => id !== "growth");
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < columns; j++) {
      const found = measured(block, i, j), cell = i * columns + j;
      for (const id of ids) block.values[id][cell] = found[id];
      block.areas[cell] = found.area;
      if (!block.thinned && !(found.jacobian > 0)) block.folded[cell] = 1;
    }
  }
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < columns; j++) block.values.growth[i * columns + j] = growth(block, i, j);
  }
  if (!block.field) return;
  const { field, nj } = block, means = new Float64Array(rows * columns);
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < columns; j++) {
      const k = i * nj + j;
      means[i * columns + j] = (field[k] + field[k + 1] + field[k + nj] + field[k + nj + 1]) / 4;
    }
  }
  block.values.field = means;
}

/** Return the range that colors cover: the fixed one, or that of the values that have a color, without infinite ones. */
function rangeOf(measure, blocks) {
  if (measure.range) return measure.range;
  let low = Infinity, high = -Infinity;
  for (const block of blocks) {
    for (const value of block.values[measure.id]) {
      if (!Number.isFinite(value) || (measure.log && value <= 0)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (low > high) return [1, 1];
  return [low, high];
}

/** Return the block and the cell with the worst value of a measure. */
function worstCell(measure, blocks) {
  let worst = null;
  for (const block of blocks) {
    block.values[measure.id].forEach((value, cell) => {
      if (!worst || (measure.low ? value < worst.value : value > worst.value)) worst = { block, cell, value };
    });
  }
  const columns = worst.block.nj - 1;
  return { block: worst.block, i: Math.floor(worst.cell / columns), j: worst.cell % columns };
}
