/* One V-cycle from a zero start: smooth, correct from the coarser levels, smooth backwards. */

enum { COARSEST_SWEEPS = 4 };

/* The residual of a row, in its place of `work`. */
APART void residual_row(const float *restrict a, const float *restrict right, const float *restrict x,
                        float *restrict residual, int64_t nj, int64_t S) {
  UNUSED const int64_t R = PLANES * S;
#pragma omp simd
  for (int64_t j = 1; j < nj - 1; ++j) {
    float sx = OWN(a, 0) * x[j] + OWN(a, 1) * x[S + j], sy = OWN(a, 2) * x[j] + OWN(a, 3) * x[S + j];
    COUPLE(0, 1, 0)
    COUPLE(1, 0, 1)
    COUPLE(2, 1, 1)
    COUPLE(3, 1, -1)
    residual[j] = right[j] - sx, residual[S + j] = right[S + j] - sy;
  }
}

static void compute_residual(const Level *level, Team team) {
  const int64_t S = level->stride, V = 2 * S;
  ROWS(level, team, i)
    residual_row(level->operator+ i * PLANES * S, level->right + i * V, level->solution + i * V, level->work + i * V,
                 level->nj, S);
  wait_for(team);
}

/* The transposed interpolation of two rows where the rows were halved. */
APART void gather_rows(const float *restrict low, const float *restrict high, float *restrict middle, int64_t count) {
#pragma omp simd
  for (int64_t j = 0; j < count; ++j) middle[j] += 0.5f * (low[j] + high[j]);
}

/* The same along a row, where the columns were halved. */
APART void gather_columns(const float *restrict from, float *restrict to, int64_t nj) {
#pragma omp simd
  for (int64_t j = 1; j < nj - 1; ++j) to[j] = from[2 * j] + 0.5f * (from[2 * j - 1] + from[2 * j + 1]);
}

/* The coarse right-hand side is the transposed interpolation of the residual, which is changed. Where the last two coarse
 * rows or columns are neighbors on the fine level, what lies beyond the last but one is the boundary, with residual 0. */
static void restrict_residual(const Level *fine, const Level *coarse, Team team) {
  const int64_t S = fine->stride, C = coarse->stride, nj = coarse->nj;
  ROWS(coarse, team, i) {
    float *row = fine->work + 2 * S * fine_index(i, coarse->ni, fine->ni), *to = coarse->right + 2 * C * i;
    const uint8_t *fixed = coarse->fixed + i * nj;
    if (coarse->ni != fine->ni) gather_rows(row - 2 * S, row + 2 * S, row, 2 * S);
    for (int c = 0; c < 2; ++c) {
      if (nj == fine->nj)
        memcpy(to + c * C + 1, row + c * S + 1, (size_t)(nj - 2) * sizeof(float));
      else
        gather_columns(row + c * S, to + c * C, nj);
      for (int64_t j = 1; j < nj - 1; ++j) to[c * C + j] = fixed[j] ? 0.0f : to[c * C + j];
    }
  }
  wait_for(team);
}

/* Add to a fine row the mean of two coarse rows, interpolated along j where the columns were halved. */
APART void correct_row(const float *restrict low, const float *restrict high, float *restrict to,
                       const uint8_t *restrict fixed, int64_t nj, int halved) {
  if (!halved) {
#pragma omp simd
    for (int64_t j = 1; j < nj - 1; ++j) to[j] += fixed[j] ? 0.0f : 0.5f * (low[j] + high[j]);
    return;
  }
#pragma omp simd
  for (int64_t k = 1; k < nj / 2; ++k) to[2 * k] += fixed[2 * k] ? 0.0f : 0.5f * (low[k] + high[k]);
#pragma omp simd
  for (int64_t k = 0; k < (nj - 1) / 2; ++k)
    to[2 * k + 1] += fixed[2 * k + 1] ? 0.0f : 0.25f * (low[k] + low[k + 1] + high[k] + high[k + 1]);
}

/* Add the bilinear interpolation of the coarse solution. */
static void correct(const Level *coarse, const Level *fine, Team team) {
  const int64_t S = fine->stride, C = coarse->stride;
  const int halve_i = coarse->ni != fine->ni, halve_j = coarse->nj != fine->nj;
  ROWS(fine, team, i) {
    const int64_t low = halve_i ? i / 2 : i, high = halve_i ? low + (i % 2) : i;
    for (int c = 0; c < 2; ++c)
      correct_row(coarse->solution + (2 * low + c) * C, coarse->solution + (2 * high + c) * C,
                  fine->solution + (2 * i + c) * S, fine->fixed + i * fine->nj, fine->nj, halve_j);
  }
  wait_for(team);
}

/* solution = V-cycle(right); small levels are worked on by one thread. */
static void v_cycle(const Level *levels, int64_t count, Team team) {
  if (team.size > 1 && levels->threads == 1) {
    if (team.rank == 0) v_cycle(levels, count, (Team){0, 1, 0});
    wait_for(team);
    return;
  }
  smooth(levels, team, 1);
  if (count > 1) {
    compute_residual(levels, team);
    restrict_residual(levels, levels + 1, team);
    v_cycle(levels + 1, count - 1, team);
    correct(levels + 1, levels, team);
  }
  for (int sweep = 1; count == 1 && sweep < COARSEST_SWEEPS; ++sweep)
    smooth_backwards(levels, team), smooth(levels, team, 0);
  smooth_backwards(levels, team);
}
