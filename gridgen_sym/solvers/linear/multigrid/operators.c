/* Setting up a level: its operator, from planes or from the level above, and the pivots of its lines. */

/* Fine index of a coarse one, where `kept` lists these or is 0. */
INLINE int64_t fine_index(const int64_t *kept, int64_t coarse, int64_t coarse_count, int64_t fine_count) {
  if (kept) return kept[coarse];
  if (coarse_count == fine_count) return coarse;
  return coarse < coarse_count - 1 ? 2 * coarse : fine_count - 1;
}

/* Whether a fine node lies between a coarse one and the next. */
INLINE int node_between(const int64_t *kept, int64_t coarse, int64_t coarse_count, int64_t fine_count) {
  if (coarse < 0 || coarse >= coarse_count - 1) return 0;
  return fine_index(kept, coarse + 1, coarse_count, fine_count) - fine_index(kept, coarse, coarse_count, fine_count) == 2;
}

/* Set the finest operator: planes (PLANES, ni, nj) times a factor, without couplings to fixed nodes. */
static void take_rows(const Level *level, Team team, const double *planes, double factor) {
  const int64_t ni = level->ni, nj = level->nj, S = level->stride, R = PLANES * S;
  ROWS(level, team, i)
    for (int plane = 0; plane < PLANES; ++plane) {
      int64_t di, dj;
      neighbor_of(plane, &di, &dj);
      const uint8_t *restrict here = fixed_row(level, i), *restrict there = fixed_row(level, i + di) + dj;
      const double *restrict from = planes + (plane * ni + i) * nj;
      float *restrict to = level->operator+ i * R + plane * S;
      for (int64_t j = 0; j < nj; ++j) to[j] = (here[j] | there[j]) ? 0.0f : (float)(factor * from[j]);
    }
}

EXPORT void take_planes(const Level *level, const double *planes, double factor) {
  WITH_TEAM(team, level->threads) take_rows(level, team, planes, factor);
}

/* Nearly all coarse columns lie two fine ones apart, but for those of a list. */
APART void coarsen_along_j(const float *restrict from, float *restrict to, int64_t fine_nj, const Level *coarse, int64_t S) {
  const int64_t nj = coarse->nj, C = coarse->stride, *kept = coarse->kept_j;
  if (kept) {
    for (int64_t j = 0; j < nj; ++j)
      coarsen_node(from + kept[j], to + j, S, C, node_between(kept, j, nj, fine_nj), node_between(kept, j - 1, nj, fine_nj));
    return;
  }
  const int last = node_between(0, nj - 2, nj, fine_nj);
  coarsen_node(from, to, S, C, node_between(0, 0, nj, fine_nj), 0);
#pragma omp simd
  for (int64_t j = 1; j < nj - 2; ++j) coarsen_node(from + 2 * j, to + j, S, C, 1, 1);
  if (nj > 2) coarsen_node(from + 2 * (nj - 2), to + nj - 2, S, C, last, 1);
  coarsen_node(from + fine_nj - 1, to + nj - 1, S, C, 0, last);
}

/* Cut the couplings with fixed nodes in the columns `begin` to `end` of a row. */
static void cut_columns(const Level *level, int64_t i, int64_t begin, int64_t end) {
  for (int plane = 0; plane < PLANES; ++plane) {
    int64_t di, dj;
    neighbor_of(plane, &di, &dj);
    const uint8_t *fixed = fixed_row(level, i), *there = fixed_row(level, i + di) + dj;
    float *row = level->operator+ (i * PLANES + plane) * level->stride;
    for (int64_t j = begin; j < end; ++j) row[j] = (fixed[j] | there[j]) ? 0.0f : row[j];
  }
}

/* The same for a whole row: fixed nodes get no correction, so nothing of them may enter a residual. */
static void cut_fixed(const Level *level, int64_t i) {
  const int64_t begin = level->begin_j, end = level->end_j;
  int some = 0;
  for (int64_t row = i - 1; row <= i + 1; ++row)
    some |= memchr(fixed_row(level, row) + begin, 1, (size_t)(end - begin)) != 0;
  cut_columns(level, i, 0, some ? level->nj : begin + 1);
  if (!some) cut_columns(level, i, end - 1, level->nj);
}

/* Set Galerkin's operator, with bilinear interpolation, one direction after the other. `row` has PLANES fine rows, and is
 * zero where they are longer than the grid. */
static void coarsen_rows(const Level *fine, const Level *coarse, Team team, float *row) {
  const int64_t S = fine->stride, C = coarse->stride, ni = coarse->ni, nj = coarse->nj;
  ROWS(coarse, team, i) {
    const float *from = fine->operator+ fine_index(coarse->kept_i, i, ni, fine->ni) * PLANES * S;
    float *to = coarse->operator+ i * PLANES * C;
    const int above = node_between(coarse->kept_i, i, ni, fine->ni), below = node_between(coarse->kept_i, i - 1, ni, fine->ni);
    coarsen_row(from, nj == fine->nj ? to : row, fine->nj, S, above, below);
    if (nj != fine->nj) coarsen_along_j(row, to, fine->nj, coarse, S);
    cut_fixed(coarse, i);
  }
}

/* The same with a team; `rows` are of every thread of the fine level. */
EXPORT void coarsen(const Level *fine, const Level *coarse, float *rows) {
  WITH_TEAM(team, fine->threads) coarsen_rows(fine, coarse, team, rows + team.rank * PLANES * fine->stride);
}

/* A 2x2 block. */
typedef struct {
  double xx, xy, yx, yy;
} Block;

/* Whether a block can be inverted; in a symmetric stencil it must be positive definite. */
INLINE int is_usable(Block b) {
  const double determinant = b.xx * b.yy - b.xy * b.yx;
#if SYMMETRIC
  return b.xx > 0.0 && determinant > 1e-7 * b.xx * b.yy;
#else
  return fabs(determinant) > 1e-7 * (fabs(b.xx * b.yy) + fabs(b.xy * b.yx));
#endif
}

/* The inverse of a pivot of block elimination along a line, own - down previous up: `previous` is the inverse pivot of the
 * node before, `down` couples with it, and `up` it with this one. Where the line's matrix is not definite, or nearly so,
 * the block itself stands in for the pivot: what is solved with stays definite. Zero at fixed nodes. */
INLINE Block invert_pivot(Block own, Block down, Block previous, Block up, int fixed) {
  const Block t = {previous.xx * up.xx + previous.xy * up.yx, previous.xx * up.xy + previous.xy * up.yy,
                   previous.yx * up.xx + previous.yy * up.yx, previous.yx * up.xy + previous.yy * up.yy};
  Block pivot = {own.xx - down.xx * t.xx - down.xy * t.yx, own.xy - down.xx * t.xy - down.xy * t.yy,
                 own.yx - down.yx * t.xx - down.yy * t.yx, own.yy - down.yx * t.xy - down.yy * t.yy};
  const int stands = is_usable(pivot) && (!SYMMETRIC || (pivot.xx > 1e-6 * own.xx && pivot.yy > 1e-6 * own.yy));
  pivot = stands ? pivot : own;
  const double scale = !fixed ? 1.0 / (pivot.xx * pivot.yy - pivot.xy * pivot.yx) : 0.0;
  return (Block){scale * pivot.yy, -scale * pivot.xy, -scale * pivot.yx, scale * pivot.xx};
}

#define GET(of, a) ((Block){of(a, 0), of(a, 1), of(a, 2), of(a, 3)})
#define SET(of, a, block) (of(a, 0) = (float)(block).xx, of(a, 1) = (float)(block).xy, of(a, 2) = (float)(block).yx, of(a, 3) = (float)(block).yy)

/* Lines along i that are eliminated side by side, and lines along j. */
enum { COLUMNS = 128, TOGETHER = 4 };

/* Pivots of `count` lines along i, at one row; `previous` has those of the row before, and then these. In double
 * precision: on sheared cells the pivots are nearly singular. */
APART void factor_row(const float *restrict a, double *restrict previous, float *restrict p,
                      const uint8_t *restrict fixed, int64_t count, int64_t S) {
  UNUSED const int64_t R = PLANES * S;
  double *restrict xx = previous, *restrict xy = xx + COLUMNS, *restrict yx = xy + COLUMNS, *restrict yy = yx + COLUMNS;
#pragma omp simd
  for (int64_t j = 0; j < count; ++j) {
    const Block before = {xx[j], xy[j], yx[j], yy[j]}, up = GET(NEXT_I, a - R);
    const Block inverse = invert_pivot(GET(OWN, a), GET(PREVIOUS_I, a), before, up, fixed[j]);
    SET(PIVOT, p, inverse);
    xx[j] = inverse.xx, xy[j] = inverse.xy, yx[j] = inverse.yx, yy[j] = inverse.yy;
  }
}

static void factor_along_i(const Level *level, int64_t column, int64_t count) {
  const int64_t S = level->stride;
  double previous[4 * COLUMNS] = {0.0};
  for (int64_t i = level->begin_i; i < level->end_i; ++i)
    factor_row(level->operator+ i * PLANES * S + column, previous, level->pivots_i + i * PIVOTS * S + column,
               fixed_row(level, i) + column, count, S);
}

/* Pivots of the lines along j at `rows` rows, side by side, since each step waits for the one before; returns how many
 * free nodes have a block that is not usable. */
INLINE int64_t factor_lines(const Level *level, int64_t i, int rows) {
  const int64_t S = level->stride, width = level->nj + 2;
  const uint8_t *restrict fixed = fixed_row(level, i);
  const float *restrict a = level->operator+ i * PLANES * S;
  float *restrict p = level->pivots_j + i * PIVOTS * S;
  int64_t unusable = 0;
  Block previous[TOGETHER] = {{0}};
  for (int64_t j = level->begin_j; j < level->end_j; ++j)
    for (int k = 0; k < rows; ++k) {
      const float *of = a + k * PLANES * S;
      float *at = p + k * PIVOTS * S;
      const Block own = GET(OWN, of), up = GET(NEXT_J, of - 1);
      previous[k] = invert_pivot(own, GET(PREVIOUS_J, of), previous[k], up, fixed[k * width + j]);
      SET(PIVOT, at, previous[k]);
      unusable += !fixed[k * width + j] && !is_usable(own);
    }
  return unusable;
}

/* Eliminate along all lines; returns how many free nodes of a thread's rows have a block that is not usable. */
static int64_t factor_all(const Level *level, Team team) {
  const int64_t columns = level->end_j - level->begin_j, rows = level->end_i - level->begin_i;
  const int64_t right = level->begin_j + share(columns, team.rank + 1, team.size);
  for (int64_t j = level->begin_j + share(columns, team.rank, team.size); j < right; j += COLUMNS)
    factor_along_i(level, j, right - j < COLUMNS ? right - j : COLUMNS);
  const int64_t end = level->begin_i + share(rows, team.rank + 1, team.size);
  int64_t i = level->begin_i + share(rows, team.rank, team.size), found = 0;
  for (; i + TOGETHER <= end; i += TOGETHER) found += factor_lines(level, i, TOGETHER);
  for (; i < end; ++i) found += factor_lines(level, i, 1);
  return found;
}

EXPORT int64_t factor(const Level *level) {
  int64_t unusable = 0;
  WITH_TEAM(team, level->threads) {
    const int64_t found = factor_all(level, team);
#pragma omp atomic
    unusable += found;
  }
  return unusable;
}
