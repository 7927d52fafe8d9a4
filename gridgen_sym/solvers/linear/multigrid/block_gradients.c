/* Conjugate gradients over several blocks: vectors of all blocks in one array, with their margins.
 *
 * x and p are the same in all copies of a node; r and q are sums over copies, of which the first has all and the others
 * have zero: parts that nearly cancel would lose digits in single precision.
 */

MULTIPLY_ROW(multiply_row, double)

typedef struct {
  double *x, *r, *p, *q;     /* solution, residual, direction, and the product with it */
  double *sums;              /* a number for each row of all blocks */
  float *right, *solution;   /* of the cycle */
  const int64_t *begin;      /* the place of the first node of each block in a vector */
  const int64_t *row_begin;  /* and of its first row in `sums` */
  const int64_t *field_begin; /* and of its first node in a field: block after block, each as planes (2, ni, nj) */
} BlockVectors;

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

/* The place of a copy of a shared node, its x, in a vector. */
INLINE int64_t place_of(const BlockLevel *level, const BlockVectors *v, int64_t e) {
  const int64_t b = level->shared->block[e];
  return v->begin[b] + 2 * level->shared->i[e] * level->levels[b].stride + level->shared->j[e];
}

/* Put the sum over the copies of every shared node into the first. */
static void gather_copies(const BlockLevel *level, const BlockVectors *v, double *vector) {
  const Shared *nodes = level->shared;
  for (int64_t n = 0; n < nodes->count; ++n) {
    double x = 0.0, y = 0.0;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const double c = nodes->turn[2 * e], s = nodes->turn[2 * e + 1];
      double *one = vector + place_of(level, v, e), *other = one + level->levels[nodes->block[e]].stride;
      x += c * *one + s * *other, y += c * *other - s * *one;
      *one = *other = 0.0;
    }
    const int64_t first = nodes->starts[n];
    double *to = vector + place_of(level, v, first);
    to[0] = x, to[level->levels[nodes->block[first]].stride] = y;
  }
}

/* Give the copies of every shared node the vector of the first. */
static void spread_copies(const BlockLevel *level, const BlockVectors *v, double *vector) {
  const Shared *nodes = level->shared;
  for (int64_t n = 0; n < nodes->count; ++n) {
    const int64_t first = nodes->starts[n];
    const double *from = vector + place_of(level, v, first);
    const double x = from[0], y = from[level->levels[nodes->block[first]].stride];
    for (int64_t e = first + 1; e < nodes->starts[n + 1]; ++e) {
      const double c = nodes->turn[2 * e], s = nodes->turn[2 * e + 1];
      double *to = vector + place_of(level, v, e);
      to[0] = c * x - s * y, to[level->levels[nodes->block[e]].stride] = s * x + c * y;
    }
  }
}

/* x += alpha p, r -= alpha q, and the right-hand side of the next cycle, scale r; returns r.r */
EXPORT double step_blocks(const BlockLevel *level, const BlockVectors *v, double alpha, double scale) {
  EACH_PART(level->size, level->threads, sums,
            step_part(alpha, v->p + from, v->q + from, v->x + from, v->r + from, v->right + from, scale, some))
  return sum_of(sums);
}

/* Begin with a right-hand side, a field that is the same in all copies and zero at fixed nodes; returns r.r */
EXPORT double begin_blocks(const BlockLevel *level, const BlockVectors *v, const double *field) {
  double *const vectors[] = {v->x, v->r, v->p, v->q};
  for (int k = 0; k < 4; ++k) memset(vectors[k], 0, (size_t)level->size * sizeof(double));
  for (int64_t b = 0; b < level->blocks; ++b) {
    const Level *block = level->levels + b;
    take_vector(block, (Team){0, 1, 0}, field + v->field_begin[b], v->r + v->begin[b]);
  }
  const Shared *nodes = level->shared;
  for (int64_t n = 0; n < nodes->count; ++n)
    for (int64_t e = nodes->starts[n] + 1; e < nodes->starts[n + 1]; ++e) {
      double *to = v->r + place_of(level, v, e);
      to[0] = to[level->levels[nodes->block[e]].stride] = 0.0;
    }
  return step_blocks(level, v, 0.0, 0.0);
}

/* z.r, z being the solution of the cycle. */
EXPORT double product_of_blocks(const BlockLevel *level, const BlockVectors *v) {
  EACH_PART(level->size, level->threads, sums, product_part(v->solution + from, v->r + from, some))
  return sum_of(sums);
}

/* p = z + beta p, and q = A p; returns p.q */
EXPORT double multiply_blocks(const BlockLevel *level, const BlockVectors *v, double beta) {
  EACH_PART(level->size, level->threads, nothing, (direction_part(beta, v->solution + from, v->p + from, some), 0.0))
  (void)nothing;
  spread_copies(level, v, v->p);
  EACH_BLOCK(level->blocks, level->threads, {
    const Level *block = level->levels + b;
    const int64_t S = block->stride;
    ROWS(block, team, i) {
      const int64_t at = v->begin[b] + 2 * i * S;
      v->sums[v->row_begin[b] + i] = multiply_row(block->operator+ i * PLANES * S, v->p + at, v->p + at, v->q + at,
                                                  0, S, S);
    }
  })
  double product = 0.0;
  for (int64_t b = 0; b < level->blocks; ++b)
    for (int64_t i = level->levels[b].begin_i; i < level->levels[b].end_i; ++i) product += v->sums[v->row_begin[b] + i];
  gather_copies(level, v, v->q);
  return product;
}

/* Write x, or p, times a factor as a field. */
EXPORT void give_blocks(const BlockLevel *level, const BlockVectors *v, int64_t direction, double factor, double *field) {
  const double *from = direction ? v->p : v->x;
  EACH_BLOCK(level->blocks, level->threads,
             give_vector(level->levels + b, team, from + v->begin[b], field + v->field_begin[b], factor);)
}
