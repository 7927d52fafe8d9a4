/* Several blocks as one grid: the same steps of a cycle on every block, and relaxation of the nodes that they share.
 *
 * Every block keeps the operator of its own cells, and a copy of the nodes on its sides. Solutions are the same in all
 * copies; right-hand sides, residuals and products are sums over copies, each of which has the part of its own cells.
 * Lines end at shared nodes, which are relaxed after the lines, one after the other, with their summed blocks.
 */

/* Nodes with several copies: those of node n are the entries starts[n] to starts[n + 1]. */
typedef struct {
  int64_t count;
  const int64_t *starts, *block, *i, *j;
  const float *turn;    /* cosine and sine of the rotation from the first copy, for each entry */
  const float *inverse; /* of the summed block of a node in the turn of its first copy: xx, xy, yy */
} Shared;

/* Do something with every block `b`, as a team: one thread for each block, or all of them if there are fewer blocks. */
#define EACH_BLOCK(blocks, threads, work)                                                                    \
  if ((blocks) >= (threads)) {                                                                               \
    PRAGMA(omp parallel for schedule(dynamic) num_threads((int)(threads)) if ((threads) > 1))                \
    for (int64_t b = 0; b < (blocks); ++b) {                                                                 \
      const Team team = {0, 1, 0};                                                                           \
      work                                                                                                   \
    }                                                                                                        \
  } else                                                                                                     \
    for (int64_t b = 0; b < (blocks); ++b) {                                                                 \
      WITH_TEAM(team, threads) { work }                                                                      \
    }

EXPORT void smooth_blocks(const Level *levels, int64_t blocks, int64_t threads, int64_t from_zero) {
  EACH_BLOCK(blocks, threads, smooth(levels + b, team, (int)from_zero);)
}

EXPORT void smooth_blocks_backwards(const Level *levels, int64_t blocks, int64_t threads) {
  EACH_BLOCK(blocks, threads, smooth_backwards(levels + b, team);)
}

EXPORT void residual_of_blocks(const Level *levels, int64_t blocks, int64_t threads) {
  EACH_BLOCK(blocks, threads, compute_residual(levels + b, team);)
}

EXPORT void restrict_blocks(const Level *fine, const Level *coarse, int64_t blocks, int64_t threads) {
  EACH_BLOCK(blocks, threads, restrict_residual(fine + b, coarse + b, team);)
}

EXPORT void correct_blocks(const Level *coarse, const Level *fine, int64_t blocks, int64_t threads) {
  EACH_BLOCK(blocks, threads, correct(coarse + b, fine + b, team);)
}

/* The residual at a node, of the cells of one block. */
static void residual_at(const Level *level, int64_t i, int64_t j, float *rx, float *ry) {
  const int64_t S = level->stride;
  UNUSED const int64_t R = PLANES * S;
  const float *a = level->operator+ i * PLANES * S, *x = level->solution + 2 * i * S, *right = level->right + 2 * i * S;
  float sx = OWN(a, 0) * x[j] + OWN(a, 1) * x[S + j], sy = OWN(a, 2) * x[j] + OWN(a, 3) * x[S + j];
  COUPLE(0, 1, 0)
  COUPLE(1, 0, 1)
  COUPLE(2, 1, 1)
  COUPLE(3, 1, -1)
  *rx = right[j] - sx, *ry = right[S + j] - sy;
}

/* Relax the shared nodes one after the other, or in the opposite order. */
EXPORT void relax_shared(const Level *levels, const Shared *nodes, int64_t backwards) {
  for (int64_t k = 0; k < nodes->count; ++k) {
    const int64_t n = backwards ? nodes->count - 1 - k : k;
    float rx = 0.0f, ry = 0.0f;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const float c = nodes->turn[2 * e], s = nodes->turn[2 * e + 1];
      float x, y;
      residual_at(levels + nodes->block[e], nodes->i[e], nodes->j[e], &x, &y);
      rx += c * x + s * y, ry += c * y - s * x;
    }
    const float *inverse = nodes->inverse + 3 * n;
    const float dx = inverse[0] * rx + inverse[1] * ry, dy = inverse[1] * rx + inverse[2] * ry;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const Level *level = levels + nodes->block[e];
      const float c = nodes->turn[2 * e], s = nodes->turn[2 * e + 1];
      float *x = level->solution + 2 * nodes->i[e] * level->stride + nodes->j[e];
      x[0] += c * dx - s * dy, x[level->stride] += s * dx + c * dy;
    }
  }
}

/* The block of each shared node with itself, summed over its copies in the turn of the first: xx, xy, yy each. */
EXPORT void sum_shared(const Level *levels, const Shared *nodes, double *sums) {
  for (int64_t n = 0; n < nodes->count; ++n) {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const Level *level = levels + nodes->block[e];
      const int64_t S = level->stride, j = nodes->j[e];
      const float *a = level->operator+ nodes->i[e] * PLANES * S;
      const double c = nodes->turn[2 * e], s = nodes->turn[2 * e + 1];
      const double p = OWN(a, 0), q = OWN(a, 1), r = OWN(a, 3);
      xx += c * c * p + 2 * c * s * q + s * s * r;
      xy += c * s * (r - p) + (c * c - s * s) * q;
      yy += s * s * p - 2 * c * s * q + c * c * r;
    }
    sums[3 * n] = xx, sums[3 * n + 1] = xy, sums[3 * n + 2] = yy;
  }
}

/* ---- conjugate gradients: vectors of all blocks in one array, with their margins ---- */

MULTIPLY_ROW(multiply_row, double)

/* result = A vector, each block its own cells; `begin` tells where the first node of a block is in a vector, `sums` has a
 * number for each row of all blocks. Returns the product of the vector and the result. */
EXPORT double multiply_blocks(const Level *levels, int64_t blocks, int64_t threads, const int64_t *begin,
                              const int64_t *row_begin, const double *vector, double *result, double *sums) {
  EACH_BLOCK(blocks, threads, {
    const Level *level = levels + b;
    const int64_t S = level->stride;
    ROWS(level, team, i) {
      const double *p = vector + begin[b] + 2 * i * S;
      sums[row_begin[b] + i] = multiply_row(level->operator+ i * PLANES * S, p, p, result + begin[b] + 2 * i * S,
                                            level->begin_j, level->end_j, S);
    }
  })
  double product = 0.0;
  for (int64_t b = 0; b < blocks; ++b)
    for (int64_t i = levels[b].begin_i; i < levels[b].end_i; ++i) product += sums[row_begin[b] + i];
  return product;
}

/* Parts in which long vectors are worked on; their sums do not depend on the number of threads. */
enum { PARTS = 64 };

#define EACH_PART(count, threads, sums, value)                                                               \
  double sums[PARTS];                                                                                        \
  (void)(threads); /* not used where there is no OpenMP */                                                   \
  PRAGMA(omp parallel for schedule(static) num_threads((int)(threads)) if ((threads) > 1))                   \
  for (int64_t part = 0; part < PARTS; ++part) {                                                             \
    const int64_t from = share(count, part, PARTS), some = share(count, part + 1, PARTS) - from;             \
    sums[part] = (value);                                                                                    \
  }

static double sum_of(const double *sums) {
  double sum = 0.0;
  for (int64_t part = 0; part < PARTS; ++part) sum += sums[part];
  return sum;
}

/* x += alpha p, r -= alpha q, right = scale r; returns the sum of the squares of r. */
EXPORT double step_vectors(int64_t count, int64_t threads, double alpha, const double *p, const double *q, double *x,
                           double *r, float *right, double scale) {
  EACH_PART(count, threads, sums,
            step_part(alpha, p + from, q + from, x + from, r + from, right + from, scale, some))
  return sum_of(sums);
}

EXPORT double product_of_vectors(int64_t count, int64_t threads, const float *z, const double *r) {
  EACH_PART(count, threads, sums, product_part(z + from, r + from, some))
  return sum_of(sums);
}

/* p = z + beta p */
EXPORT void next_direction(int64_t count, int64_t threads, double beta, const float *z, double *p) {
  EACH_PART(count, threads, sums, (direction_part(beta, z + from, p + from, some), 0.0))
  (void)sums;
}
