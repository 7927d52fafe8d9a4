// Filled cells, pixel by pixel: without seams between neighbors, and at any zoom.

/** Colors from good to bad: light to dark, readable without red and green (ColorBrewer's YlGnBu); red is for folds. */
const GOOD_TO_BAD = ["#ffffd9", "#edf8b1", "#c7e9b4", "#7fcdbb", "#41b6c4", "#1d91c0", "#225ea8", "#253494", "#081d58"];
/** Colors of a field, from low to high (viridis). */
const LOW_TO_HIGH = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const SHADES = 64;

/** Return red, green and blue of a color such as #d7191c. */
function channels(color) {
  return [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
}

/** Return a color as an entry of an image. */
function packed([red, green, blue]) {
  return (255 << 24) | (Math.round(blue) << 16) | (Math.round(green) << 8) | Math.round(red);
}

/** Return entries of an image between colors. */
function shades(colors) {
  return Uint32Array.from({ length: SHADES }, (_, shade) => {
    const at = (shade / (SHADES - 1)) * (colors.length - 1), k = Math.min(Math.floor(at), colors.length - 2);
    const [from, to] = [channels(colors[k]), channels(colors[k + 1])];
    return packed(from.map((value, channel) => value + (at - k) * (to[channel] - value)));
  });
}

/** Return the number of the shade of a value: 0 at the good end of the range. */
function shadeOf(measure, range, value) {
  let part = (value - range[0]) / (range[1] - range[0] || 1);
  if (measure.log) part = value > 0 ? Math.log(value / range[0]) / (Math.log(range[1] / range[0]) || 1) : 0;
  if (measure.low) part = 1 - part;
  return Math.round(Math.min(1, Math.max(0, Number.isNaN(part) ? 1 : part)) * (SHADES - 1));
}

/** Fill a quadrilateral of an image, corner by corner, as two triangles. */
function fillQuad(image, ax, ay, bx, by, cx, cy, dx, dy, color) {
  // Cut along the diagonal that lies inside: of a cell with a reflex corner that is only one of the two.
  const oneTurn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax), otherTurn = (cx - ax) * (dy - ay) - (cy - ay) * (dx - ax);
  if (oneTurn > 0 === otherTurn > 0) {
    fillTriangle(image, ax, ay, bx, by, cx, cy, color);
    fillTriangle(image, ax, ay, cx, cy, dx, dy, color);
  } else {
    fillTriangle(image, ax, ay, bx, by, dx, dy, color);
    fillTriangle(image, bx, by, cx, cy, dx, dy, color);
  }
}

/** Fill the pixels whose centers lie in a triangle. */
function fillTriangle(image, ax, ay, bx, by, cx, cy, color) {
  let swap;
  if (by < ay) { swap = ax; ax = bx; bx = swap; swap = ay; ay = by; by = swap; }
  if (cy < ay) { swap = ax; ax = cx; cx = swap; swap = ay; ay = cy; cy = swap; }
  if (cy < by) { swap = bx; bx = cx; cx = swap; swap = by; by = cy; cy = swap; }
  const { pixels, width, height } = image, first = Math.max(0, Math.ceil(ay - 0.5));
  const last = Math.min(height - 1, Math.ceil(cy - 0.5) - 1);
  for (let row = first; row <= last; row++) {
    const level = row + 0.5, long = ax + ((level - ay) / (cy - ay)) * (cx - ax);
    const short = level < by ? ax + ((level - ay) / (by - ay)) * (bx - ax) : bx + ((level - by) / (cy - by || 1)) * (cx - bx);
    const from = Math.max(0, Math.ceil(Math.min(long, short) - 0.5));
    const to = Math.min(width, Math.ceil(Math.max(long, short) - 0.5));
    if (from < to) pixels.fill(color, row * width + from, row * width + to);
  }
}

/** Paint the cells of a tile between its lines, each in the color of the worst cell in it; return its folded ones. */
function paintTile(image, view, block, tile, lines, measure, range, colors, folded) {
  const { x, y, nj, folded: flags } = block, values = block.values[measure.id], columns = nj - 1;
  for (let p = 1; p < lines.i.length; p++) {
    const i0 = lines.i[p - 1], i1 = lines.i[p];
    for (let q = 1; q < lines.j.length; q++) {
      const j0 = lines.j[q - 1], j1 = lines.j[q];
      let worst = values ? values[i0 * columns + j0] : 0, fold = 0;
      for (let i = i0; i < i1; i++) {
        for (let cell = i * columns + j0; cell < i * columns + j1; cell++) {
          fold |= flags[cell];
          if (values && (measure.low ? values[cell] < worst : values[cell] > worst)) worst = values[cell];
        }
      }
      const a = i0 * nj + j0, b = i1 * nj + j0, c = i1 * nj + j1, d = i0 * nj + j1;
      if (fold) folded.push(view.px(x[a]), view.py(y[a]), view.px(x[b]), view.py(y[b]), view.px(x[c]), view.py(y[c]), view.px(x[d]), view.py(y[d]));
      else if (values && !Number.isNaN(worst)) {
        const color = colors[shadeOf(measure, range, worst)];
        fillQuad(image, view.px(x[a]), view.py(y[a]), view.px(x[b]), view.py(y[b]), view.px(x[c]), view.py(y[c]), view.px(x[d]), view.py(y[d]), color);
      }
    }
  }
}

/** Fill single empty pixels, which are left where a tile shows a line and its neighbor does not. */
function closeHoles({ pixels, width, height }) {
  for (let k = width + 1; k < width * (height - 1) - 1; k++) {
    if (pixels[k] === 0 && pixels[k - 1] && pixels[k + 1] && pixels[k - width] && pixels[k + width]) pixels[k] = pixels[k - 1];
  }
}

/** Paint folded cells over all others, the smallest as dots of `dot` pixels. */
function paintFolded(image, folded, color, dot) {
  const { pixels, width, height } = image;
  for (let k = 0; k < folded.length; k += 8) {
    const q = folded.slice(k, k + 8);
    fillQuad(image, ...q, color);
    const xs = [q[0], q[2], q[4], q[6]], ys = [q[1], q[3], q[5], q[7]];
    if (Math.max(...xs) - Math.min(...xs) > dot && Math.max(...ys) - Math.min(...ys) > dot) continue;
    const left = Math.round((xs[0] + xs[1] + xs[2] + xs[3]) / 4 - dot / 2), top = Math.round((ys[0] + ys[1] + ys[2] + ys[3]) / 4 - dot / 2);
    const from = Math.max(0, left), to = Math.min(width, left + dot);
    for (let row = Math.max(0, top); row < Math.min(height, top + dot) && from < to; row++) {
      pixels.fill(color, row * width + from, row * width + to);
    }
  }
}
