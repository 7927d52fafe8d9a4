// Level of detail: each block is cut into tiles, and a tile shows only the lines that are apart on the screen.

const TILE = 32;

/** Give a block its tiles: ranges of cells with the box that holds their nodes. */
function cutIntoTiles(block) {
  const { ni, nj, x, y } = block;
  block.tiles = [];
  for (let i0 = 0; i0 < ni - 1; i0 += TILE) {
    for (let j0 = 0; j0 < nj - 1; j0 += TILE) {
      const i1 = Math.min(i0 + TILE, ni - 1), j1 = Math.min(j0 + TILE, nj - 1);
      const tile = { i0, j0, i1, j1, left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
      for (let i = i0; i <= i1; i++) {
        for (let k = i * nj + j0; k <= i * nj + j1; k++) {
          tile.left = Math.min(tile.left, x[k]);
          tile.right = Math.max(tile.right, x[k]);
          tile.low = Math.min(tile.low, y[k]);
          tile.high = Math.max(tile.high, y[k]);
        }
      }
      block.tiles.push(tile);
    }
  }
}

/** Return whether a tile may be seen in a box. */
function meets(tile, box) {
  return tile.left <= box.right && tile.right >= box.left && tile.low <= box.high && tile.high >= box.low;
}

/** Return the lines of a tile along one axis that are at least `apart` from the one before, with the first and last.
 *
 * @param {number} first The first line, and `last` the last one.
 * @param {number} stride From a node to the next one along the axis, in the arrays.
 * @param {number[]} starts The nodes at which three lines across begin: at the first line.
 * @param {number} apart The distance, in the unit of the grid.
 * @returns {number[]} The lines.
 */
function linesApart(block, first, last, stride, starts, apart) {
  const { x, y } = block, at = [first], sums = [0, 0, 0];
  for (let line = first + 1; line <= last; line++) {
    for (let s = 0; s < 3; s++) {
      const k = starts[s] + (line - first) * stride, dx = x[k] - x[k - stride], dy = y[k] - y[k - stride];
      sums[s] += Math.sqrt(dx * dx + dy * dy);
    }
    const most = Math.max(sums[0], sums[1], sums[2]);
    if (most >= apart || line === last) {
      at.push(line);
      sums.fill(0);
    }
  }
  return at;
}

/** Return the lines of both families that a tile shows. */
function linesOf(block, tile, apart) {
  const { nj } = block, { i0, i1, j0, j1 } = tile, middleI = (i0 + i1) >> 1, middleJ = (j0 + j1) >> 1;
  return {
    i: linesApart(block, i0, i1, nj, [j0, middleJ, j1].map((j) => i0 * nj + j), apart),
    j: linesApart(block, j0, j1, 1, [i0, middleI, i1].map((i) => i * nj + j0), apart),
  };
}

/** Return the cells that have a point in them, the folded ones first, since they are drawn over the others. */
function cellsAt(blocks, px, py) {
  const found = [], point = { left: px, right: px, low: py, high: py };
  for (const block of blocks) {
    for (const tile of block.tiles.filter((one) => meets(one, point))) {
      for (let i = tile.i0; i < tile.i1; i++) {
        for (let j = tile.j0; j < tile.j1; j++) {
          if (!holds(block, i, j, px, py)) continue;
          const folded = block.folded[i * (block.nj - 1) + j];
          if (folded) found.unshift({ block, i, j });
          else found.push({ block, i, j });
        }
      }
    }
  }
  return found;
}

/** Return whether a point is inside a cell: a ray from it crosses the four edges an odd number of times. */
function holds(block, i, j, px, py) {
  const { x, y, nj } = block, k = i * nj + j, nodes = [k, k + nj, k + nj + 1, k + 1];
  let inside = false;
  for (let n = 0, m = 3; n < 4; m = n++) {
    const a = nodes[n], b = nodes[m];
    if (y[a] > py !== y[b] > py && px < ((x[b] - x[a]) * (py - y[a])) / (y[b] - y[a]) + x[a]) inside = !inside;
  }
  return inside;
}
