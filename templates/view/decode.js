// From the text of the page to blocks of nodes: doubles, bit by bit those of the grid.

/** Return the doubles of base64 text: deflated planes of bytes of second differences along each row. */
async function unpack(text, rows, columns) {
  const raw = atob(text), packed = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) packed[k] = raw.charCodeAt(k);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = rows * columns, words = new Uint32Array(2 * count);
  for (let byte = 0; byte < 8; byte++) {
    const half = byte >> 2, shift = 8 * (byte & 3), from = byte * count;
    for (let k = 0; k < count; k++) words[2 * k + half] |= bytes[from + k] << shift;
  }
  for (let pass = 0; pass < 2; pass++) {
    for (let row = 0; row < rows; row++) {
      for (let k = row * columns + 1; k < (row + 1) * columns; k++) {
        const low = words[2 * k] + words[2 * k - 2];
        words[2 * k] = low;
        words[2 * k + 1] += words[2 * k - 1] + (low > 0xffffffff ? 1 : 0);
      }
    }
  }
  return new Float64Array(words.buffer);
}

/** Return a block with its nodes, node (i, j) at i * nj + j, and the flags of its folded cells, if it is thinned. */
async function unpackBlock(given) {
  const [ni, nj] = given.shape, planes = await unpack(given.nodes, 2 * ni, nj);
  const x = planes.subarray(0, ni * nj), y = planes.subarray(ni * nj);
  const block = { name: given.name, ni, nj, x, y, full: given.full, steps: given.steps, thinned: given.folded !== null };
  if (given.field) block.field = await unpack(given.field, ni, nj);
  block.folded = new Uint8Array((ni - 1) * (nj - 1));
  for (const cell of given.folded ?? []) block.folded[cell] = 1;
  return block;
}
