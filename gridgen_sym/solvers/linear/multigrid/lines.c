/* Smoothing: zebra line relaxation, along j and along i.
 *
 * All nodes of a line are solved for at once, every second line first, so that errors go that are smooth along strong
 * couplings and rough across them: those of stretched cells, in whichever direction. Elimination is block Thomas':
 * g_n = P_n (r_n - D_n g_(n-1)), then x_n = g_n - P_n U_n x_(n+1), with the inverse pivots P of `factor`, D and U the
 * couplings with the previous and the next node of the line, r the right-hand side less the couplings with other lines.
 */

/* ---- along j: lines of a row ---- */

/* r of a row; where the solution is zero off the lines, only the right-hand side. */
APART void line_right(const float *restrict a, const float *restrict right, const float *restrict x, float *restrict r,
                      int64_t begin, int64_t end, int64_t S, int from_zero) {
  UNUSED const int64_t R = PLANES * S;
  if (from_zero) {
    memcpy(r, right, (size_t)(2 * S) * sizeof(float));
    return;
  }
#pragma omp simd
  for (int64_t j = begin; j < end; ++j) {
    float sx = 0.0f, sy = 0.0f;
    COUPLE(0, 1, 0)
    COUPLE(2, 1, 1)
    COUPLE(3, 1, -1)
    r[j] = right[j] - sx, r[S + j] = right[S + j] - sy;
  }
}

/* Solve the lines of `rows` rows i, i + 2, ...; side by side, since each step waits for the one before. */
INLINE void solve_rows(const Level *level, int64_t i, int rows) {
  const int64_t begin = level->begin_j, end = level->end_j;
  const int64_t S = level->stride, A = 2 * PLANES * S, P = 2 * PIVOTS * S, V = 4 * S;
  const float *restrict a = level->operator+ i * PLANES * S, *restrict p = level->pivots_j + i * PIVOTS * S;
  float *restrict g = level->work + 2 * i * S, *restrict x = level->solution + 2 * i * S;
  float last_x[4], last_y[4]; /* what the line goes on to, before and after it: zero, but for nodes shared with a block */
  for (int k = 0; k < rows; ++k) last_x[k] = x[k * V + begin - 1], last_y[k] = x[k * V + S + begin - 1];
  for (int64_t j = begin; j < end; ++j)
    for (int k = 0; k < rows; ++k) {
      const float *b = a + k * A, *q = p + k * P;
      const float rx = g[k * V + j] - PREVIOUS_J(b, 0) * last_x[k] - PREVIOUS_J(b, 1) * last_y[k];
      const float ry = g[k * V + S + j] - PREVIOUS_J(b, 2) * last_x[k] - PREVIOUS_J(b, 3) * last_y[k];
      g[k * V + j] = last_x[k] = PIVOT(q, 0) * rx + PIVOT(q, 1) * ry;
      g[k * V + S + j] = last_y[k] = PIVOT(q, 2) * rx + PIVOT(q, 3) * ry;
    }
  for (int k = 0; k < rows; ++k) last_x[k] = x[k * V + end], last_y[k] = x[k * V + S + end];
  for (int64_t j = end - 1; j >= begin; --j)
    for (int k = 0; k < rows; ++k) {
      const float *b = a + k * A, *q = p + k * P;
      const float ux = NEXT_J(b, 0) * last_x[k] + NEXT_J(b, 1) * last_y[k];
      const float uy = NEXT_J(b, 2) * last_x[k] + NEXT_J(b, 3) * last_y[k];
      x[k * V + j] = last_x[k] = g[k * V + j] - PIVOT(q, 0) * ux - PIVOT(q, 1) * uy;
      x[k * V + S + j] = last_y[k] = g[k * V + S + j] - PIVOT(q, 2) * ux - PIVOT(q, 3) * uy;
    }
}

/* Relax the lines along j, every second one: from the first or from the second on. */
static void relax_along_j(const Level *level, Team team, int parity, int from_zero) {
  const int64_t S = level->stride, first = level->begin_i + parity, lines = (level->end_i - first + 1) / 2;
  int64_t line = share(lines, team.rank, team.size);
  const int64_t end = share(lines, team.rank + 1, team.size);
  while (line < end) {
    const int rows = line + 4 <= end ? 4 : 1;
    for (int64_t k = line; k < line + rows; ++k) {
      const int64_t i = first + 2 * k;
      line_right(level->operator+ i * PLANES * S, level->right + 2 * i * S, level->solution + 2 * i * S,
                 level->work + 2 * i * S, 0, S, S, from_zero);
    }
    if (rows == 4)
      solve_rows(level, first + 2 * line, 4);
    else
      solve_rows(level, first + 2 * line, 1);
    line += rows;
  }
  wait_for(team);
}

/* ---- along i: row after row, for all columns at once; every second one is kept, from `begin` on ---- */

APART void eliminate_row(const float *restrict a, const float *restrict p, const float *restrict right,
                         const float *restrict x, const float *restrict before, float *restrict g, int64_t begin,
                         int64_t end, int64_t S) {
  UNUSED const int64_t R = PLANES * S;
#pragma omp simd
  for (int64_t j = begin; j < end; ++j) {
    float sx = 0.0f, sy = 0.0f;
    COUPLE(1, 0, 1)
    COUPLE(2, 1, 1)
    COUPLE(3, 1, -1)
    const float rx = right[j] - sx - PREVIOUS_I(a, 0) * before[j] - PREVIOUS_I(a, 1) * before[S + j];
    const float ry = right[S + j] - sy - PREVIOUS_I(a, 2) * before[j] - PREVIOUS_I(a, 3) * before[S + j];
    g[j] = PIVOT(p, 0) * rx + PIVOT(p, 1) * ry;
    g[S + j] = PIVOT(p, 2) * rx + PIVOT(p, 3) * ry;
  }
}

APART void substitute_row(const float *restrict a, const float *restrict p, const float *restrict g,
                          const float *restrict above, float *restrict x, int64_t begin, int64_t end, int64_t S) {
#pragma omp simd
  for (int k = 0; k < (int)(end - begin); ++k) {
    const int64_t j = begin + k;
    const float ux = NEXT_I(a, 0) * above[j] + NEXT_I(a, 1) * above[S + j];
    const float uy = NEXT_I(a, 2) * above[j] + NEXT_I(a, 3) * above[S + j];
    const float to_x = g[j] - PIVOT(p, 0) * ux - PIVOT(p, 1) * uy;
    const float to_y = g[S + j] - PIVOT(p, 2) * ux - PIVOT(p, 3) * uy;
    if (k % 2 == 0) x[j] = to_x, x[S + j] = to_y;
  }
}

/* Relax the lines along i, every second one. A thread goes from the first to the last of its own columns: the
 * columns of others that it reads next to them are not written meanwhile. */
static void relax_along_i(const Level *level, Team team, int parity) {
  const int64_t S = level->stride, V = 2 * S, columns = level->end_j - level->begin_j;
  int64_t begin = share(columns, team.rank, team.size), end = share(columns, team.rank + 1, team.size);
  begin += level->begin_j + (begin + parity) % 2;
  end += level->begin_j;
  end -= (end - begin) % 2 == 0;
  for (int64_t i = level->begin_i; i < level->end_i; ++i) {
    float *g = level->work + i * V;
    const float *before = i > level->begin_i ? g - V : level->solution + (i - 1) * V;
    /* Whole rows take fewer instructions; what stands in other columns, and in the margin, is not used. */
    eliminate_row(level->operator+ i * PLANES * S, level->pivots_i + i * PIVOTS * S, level->right + i * V,
                  level->solution + i * V, before, g, team.size == 1 ? 0 : begin, team.size == 1 ? S : end, S);
  }
  for (int64_t i = level->end_i - 1; i >= level->begin_i; --i) {
    float *x = level->solution + i * V;
    substitute_row(level->operator+ i * PLANES * S, level->pivots_i + i * PIVOTS * S, level->work + i * V, x + V, x, begin,
                   end, S);
  }
  wait_for(team);
}

/* Once along j and along i, or backwards: the two together are a symmetric preconditioner. */
static void smooth(const Level *level, Team team, int from_zero) {
  relax_along_j(level, team, 0, from_zero);
  relax_along_j(level, team, 1, 0);
  relax_along_i(level, team, 0);
  relax_along_i(level, team, 1);
}

static void smooth_backwards(const Level *level, Team team) {
  relax_along_i(level, team, 1);
  relax_along_i(level, team, 0);
  relax_along_j(level, team, 1, 0);
  relax_along_j(level, team, 0, 0);
}
