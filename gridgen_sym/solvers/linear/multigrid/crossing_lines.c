/* Lines that cross a connection: where cells are thin across it, the node there moves with its lines.
 *
 * A shared node couples so strongly with the lines on both sides that relaxing it alone, or these alone, does little. With
 * the lines' own equations it has the basis vector phi: 1 at the node, and what follows along the lines. Corrections
 * along phi, for all such nodes at once and damped, are a subspace correction of the residual r: phi.r / phi.A phi.
 */

/* The nodes, a part of the shared ones. */
typedef struct {
  int64_t count, most;
  int64_t *node;      /* number among the shared nodes */
  float *inverse;     /* of phi.A phi: xx, xy, yy */
  int64_t *line;      /* for each entry of the shared nodes: where its line begins in `along`, or -1 */
  float *along;       /* phi at the nodes of all lines: xx, xy, yx, yy each */
  uint8_t *blocks;    /* whether a block has such lines */
  double weakest;     /* the least part of a node's own block that is not coupled with these lines: of thin cells, about
                         the square of height over length */
} Crossing;

/* Where the inner nodes of the line into a block lie, from a node inside a side; the number is 0 at a corner. */
typedef struct {
  int64_t di, dj, count;
} Inward;

static Inward inward(const Level *level, int64_t i, int64_t j) {
  const int64_t last_i = level->ni - 1, last_j = level->nj - 1;
  const int on_i = i == 0 || i == last_i, on_j = j == 0 || j == last_j;
  if (on_i == on_j) return (Inward){0, 0, 0};
  if (on_i) return (Inward){i == 0 ? 1 : -1, 0, last_i - 1};
  return (Inward){0, j == 0 ? 1 : -1, last_j - 1};
}

/* The block of a node with itself, or with the next one in a direction. */
static Block block_of(const Level *level, int64_t i, int64_t j, int64_t di, int64_t dj) {
  const int64_t S = level->stride;
  UNUSED const int64_t R = PLANES * S;
  const float *a = level->operator+ i * PLANES * S;
  if (di == 1) return GET(NEXT_I, a);
  if (di == -1) return GET(PREVIOUS_I, a);
  if (dj == 1) return GET(NEXT_J, a);
  if (dj == -1) return GET(PREVIOUS_J, a);
  return GET(OWN, a);
}

static Block product(Block a, Block b) {
  return (Block){a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx,
                 a.yx * b.xy + a.yy * b.yy};
}

static Block inverse_of(Block a) {
  const double scale = 1.0 / (a.xx * a.yy - a.xy * a.yx);
  return (Block){scale * a.yy, -scale * a.xy, -scale * a.yx, scale * a.xx};
}

/* R^T B R added to a sum, symmetric. */
static void add_turned(double *sum, Block b, double c, double s) {
  const double mixed = 0.5 * (b.xy + b.yx);
  sum[0] += c * c * b.xx + 2 * c * s * mixed + s * s * b.yy;
  sum[1] += c * s * (b.yy - b.xx) + (c * c - s * s) * mixed;
  sum[2] += s * s * b.xx - 2 * c * s * mixed + c * c * b.yy;
}

/* Eliminate along the line into a block, from its far end, and write phi; returns what is left of the node's own block. */
static Block eliminate_inward(const Level *level, int64_t i, int64_t j, Inward in, float *along) {
  Block transfer = {0};
  for (int64_t k = in.count; k > 0; --k) {
    const int64_t at_i = i + k * in.di, at_j = j + k * in.dj;
    Block own = block_of(level, at_i, at_j, 0, 0);
    if (k < in.count) {
      const Block far = product(block_of(level, at_i, at_j, in.di, in.dj), transfer);
      own = (Block){own.xx - far.xx, own.xy - far.xy, own.yx - far.yx, own.yy - far.yy};
    }
    transfer = product(inverse_of(own), block_of(level, at_i, at_j, -in.di, -in.dj));
    float *z = along + 4 * (k - 1);
    z[0] = (float)transfer.xx, z[1] = (float)transfer.xy, z[2] = (float)transfer.yx, z[3] = (float)transfer.yy;
  }
  Block phi = {1.0, 0.0, 0.0, 1.0};
  for (int64_t k = 0; k < in.count; ++k) {
    float *z = along + 4 * k;
    phi = product((Block){-z[0], -z[1], -z[2], -z[3]}, phi);
    z[0] = (float)phi.xx, z[1] = (float)phi.xy, z[2] = (float)phi.yx, z[3] = (float)phi.yy;
  }
  const Block own = block_of(level, i, j, 0, 0), down = product(block_of(level, i, j, in.di, in.dj), transfer);
  return (Block){own.xx - down.xx, own.xy - down.xy, own.yx - down.yx, own.yy - down.yy};
}

/* Part of a shared node's own block above which the couplings across the connection are strong. */
#define STRONG 0.8

/* The part of a node's own block that is not coupled with the lines across the sides that it lies inside; 1 at a corner. */
static double part_beside_lines(const Level *levels, const Shared *nodes, int64_t n) {
  double own = 0.0, across = 0.0;
  for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
    const Level *level = levels + nodes->block[e];
    const int64_t i = nodes->i[e], j = nodes->j[e];
    const Inward in = inward(level, i, j);
    if (in.count == 0) return 1.0;
    const Block itself = block_of(level, i, j, 0, 0), next = block_of(level, i, j, in.di, in.dj);
    own += itself.xx + itself.yy, across += fabs(next.xx + next.yy);
  }
  return own > 0.0 ? 1.0 - across / own : 1.0;
}

/* Find the nodes, and their vectors phi; there is room for `most` nodes on lines. Returns how many there are, or -1 if
 * there is not enough room. */
static int64_t find_crossing(const Level *levels, int64_t blocks, const Shared *nodes, Crossing *crossing) {
  int64_t found = 0, used = 0;
  memset(crossing->blocks, 0, (size_t)blocks);
  crossing->weakest = 1.0;
  for (int64_t n = 0; n < nodes->count; ++n) {
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) crossing->line[e] = -1;
    const double part = part_beside_lines(levels, nodes, n);
    if (!(part < 1.0 - STRONG)) continue;
    if (part < crossing->weakest) crossing->weakest = part;
    double sum[3] = {0.0, 0.0, 0.0};
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const Level *level = levels + nodes->block[e];
      const Inward in = inward(level, nodes->i[e], nodes->j[e]);
      if (used + in.count > crossing->most) return -1;
      crossing->line[e] = 4 * used;
      crossing->blocks[nodes->block[e]] = 1;
      add_turned(sum, eliminate_inward(level, nodes->i[e], nodes->j[e], in, crossing->along + 4 * used),
                 nodes->turn[2 * e], nodes->turn[2 * e + 1]);
      used += in.count;
    }
    const double determinant = sum[0] * sum[2] - sum[1] * sum[1];
    if (!(sum[0] > 0.0 && determinant > 1e-7 * sum[0] * sum[2])) continue;
    float *inverse = crossing->inverse + 3 * found;
    inverse[0] = (float)(sum[2] / determinant), inverse[1] = (float)(-sum[1] / determinant);
    inverse[2] = (float)(sum[0] / determinant);
    crossing->node[found++] = n;
  }
  crossing->count = found;
  return found;
}

/* Damping of corrections that are made at once. */
#define DAMPED 0.6f

/* Correct the solution along all vectors phi by the residuals, which are in `work`. */
static void correct_crossing(const Level *levels, const Shared *nodes, const Crossing *crossing) {
  for (int64_t k = 0; k < crossing->count; ++k) {
    const int64_t n = crossing->node[k];
    float rx = 0.0f, ry = 0.0f;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const Level *level = levels + nodes->block[e];
      const Inward in = inward(level, nodes->i[e], nodes->j[e]);
      const int64_t S = level->stride, step = 2 * S * in.di + in.dj;
      const float *r = level->work + 2 * S * nodes->i[e] + nodes->j[e], *phi = crossing->along + crossing->line[e];
      float x = r[0], y = r[S];
      for (int64_t m = 0; m < in.count; ++m, phi += 4) {
        r += step;
        x += phi[0] * r[0] + phi[2] * r[S], y += phi[1] * r[0] + phi[3] * r[S];
      }
      const float c = (float)nodes->turn[2 * e], s = (float)nodes->turn[2 * e + 1];
      rx += c * x + s * y, ry += c * y - s * x;
    }
    const float *inverse = crossing->inverse + 3 * k;
    const float dx = DAMPED * (inverse[0] * rx + inverse[1] * ry), dy = DAMPED * (inverse[1] * rx + inverse[2] * ry);
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const Level *level = levels + nodes->block[e];
      const Inward in = inward(level, nodes->i[e], nodes->j[e]);
      const int64_t S = level->stride, step = 2 * S * in.di + in.dj;
      const float c = (float)nodes->turn[2 * e], s = (float)nodes->turn[2 * e + 1];
      const float x = c * dx - s * dy, y = s * dx + c * dy;
      float *to = level->solution + 2 * S * nodes->i[e] + nodes->j[e];
      const float *phi = crossing->along + crossing->line[e];
      to[0] += x, to[S] += y;
      for (int64_t m = 0; m < in.count; ++m, phi += 4) {
        to += step;
        to[0] += phi[0] * x + phi[1] * y, to[S] += phi[2] * x + phi[3] * y;
      }
    }
  }
}
