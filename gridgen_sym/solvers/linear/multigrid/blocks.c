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
  const double *turn; /* cosine and sine of the rotation from the first copy, for each entry */
  float *inverse;     /* of the summed block of a node in the turn of its first copy: xx, xy, yy */
  float *stencil;     /* of each entry: its block with itself, then with the neighbors as in `neighbors` */
} Shared;

/* How many numbers a stencil has: a block xx, xy, yx, yy for the node itself, and for each of these and the one opposite. */
enum { STENCIL = 36 };
static const int neighbors[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};

#ifdef _OPENMP
#define OWN_NUMBER omp_get_thread_num()
#else
#define OWN_NUMBER 0
#endif

/* Do something with every block `b`, as a team: one thread for each block, or all of them if there are fewer blocks. The
 * thread has the number `own`. */
#define EACH_BLOCK(blocks, threads, work)                                                                    \
  if ((blocks) >= (threads)) {                                                                               \
    PRAGMA(omp parallel for schedule(dynamic) num_threads((int)(threads)) if ((threads) > 1))                \
    for (int64_t b = 0; b < (blocks); ++b) {                                                                 \
      const Team team = {0, 1, 0};                                                                           \
      UNUSED const int64_t own = OWN_NUMBER;                                                                 \
      work                                                                                                   \
    }                                                                                                        \
  } else                                                                                                     \
    for (int64_t b = 0; b < (blocks); ++b) {                                                                 \
      WITH_TEAM(team, threads) {                                                                             \
        UNUSED const int64_t own = team.rank;                                                                \
        work                                                                                                 \
      }                                                                                                      \
    }

/* Gather the stencil of a node, which lies far apart in the operator. */
static void gather_stencil(const Level *level, int64_t i, int64_t j, float *to) {
  const int64_t S = level->stride, R = PLANES * S;
  const float *a = level->operator+ i * R;
  for (int e = 0; e < 4; ++e) to[e] = OWN(a, e);
  for (int k = 0; k < 4; ++k) {
    const int64_t back = j - neighbors[k][0] * R - neighbors[k][1];
    for (int e = 0; e < 4; ++e) {
      to[4 + 8 * k + e] = a[(3 + 4 * k + e) * S + j];
      to[8 + 8 * k + e] = a[(3 + 4 * k + transposed[e]) * S + back];
    }
  }
}

/* The residual at a node, of the cells of one block. */
static void residual_at(const Level *level, int64_t i, int64_t j, const float *stencil, float *rx, float *ry) {
  const int64_t S = level->stride;
  const float *x = level->solution + 2 * i * S + j, *right = level->right + 2 * i * S + j, *a = stencil;
  float sx = a[0] * x[0] + a[1] * x[S], sy = a[2] * x[0] + a[3] * x[S];
  for (int k = 0; k < 4; ++k) {
    const int64_t to = neighbors[k][0] * 2 * S + neighbors[k][1];
    const float *b = a + 4 + 8 * k, *c = b + 4;
    sx += b[0] * x[to] + b[1] * x[S + to] + c[0] * x[-to] + c[1] * x[S - to];
    sy += b[2] * x[to] + b[3] * x[S + to] + c[2] * x[-to] + c[3] * x[S - to];
  }
  *rx = right[0] - sx, *ry = right[S] - sy;
}

/* Relax the shared nodes one after the other, or in the opposite order. */
static void relax_shared(const Level *levels, const Shared *nodes, int64_t backwards) {
  for (int64_t k = 0; k < nodes->count; ++k) {
    const int64_t n = backwards ? nodes->count - 1 - k : k;
    float rx = 0.0f, ry = 0.0f;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const float c = (float)nodes->turn[2 * e], s = (float)nodes->turn[2 * e + 1];
      float x, y;
      residual_at(levels + nodes->block[e], nodes->i[e], nodes->j[e], nodes->stencil + STENCIL * e, &x, &y);
      rx += c * x + s * y, ry += c * y - s * x;
    }
    const float *inverse = nodes->inverse + 3 * n;
    const float dx = inverse[0] * rx + inverse[1] * ry, dy = inverse[1] * rx + inverse[2] * ry;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      const Level *level = levels + nodes->block[e];
      const float c = (float)nodes->turn[2 * e], s = (float)nodes->turn[2 * e + 1];
      float *x = level->solution + 2 * nodes->i[e] * level->stride + nodes->j[e];
      x[0] += c * dx - s * dy, x[level->stride] += s * dx + c * dy;
    }
  }
}

/* Gather the stencils of shared nodes, and invert the block of each with itself, summed over its copies in the turn of the
 * first; returns how many are not positive definite. */
static int64_t factor_shared(const Level *levels, const Shared *nodes) {
  int64_t unusable = 0;
  for (int64_t n = 0; n < nodes->count; ++n) {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (int64_t e = nodes->starts[n]; e < nodes->starts[n + 1]; ++e) {
      float *own = nodes->stencil + STENCIL * e;
      gather_stencil(levels + nodes->block[e], nodes->i[e], nodes->j[e], own);
      const double c = nodes->turn[2 * e], s = nodes->turn[2 * e + 1];
      const double p = own[0], q = own[1], r = own[3];
      xx += c * c * p + 2 * c * s * q + s * s * r;
      xy += c * s * (r - p) + (c * c - s * s) * q;
      yy += s * s * p - 2 * c * s * q + c * c * r;
    }
    const Block block = {xx, xy, xy, yy};
    const double determinant = xx * yy - xy * xy;
    float *inverse = nodes->inverse + 3 * n;
    unusable += !is_usable(block);
    inverse[0] = (float)(yy / determinant), inverse[1] = (float)(-xy / determinant), inverse[2] = (float)(xx / determinant);
  }
  return unusable;
}
