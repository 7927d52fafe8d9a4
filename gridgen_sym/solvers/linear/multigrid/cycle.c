/* The way between a level and the next coarser one: residual, restriction, correction. */

/* The residual of a row, in its place of `work`; of whole rows, the last number of the margin is not zero. */
APART void residual_row(const float *restrict a, const float *restrict right, const float *restrict x,
                        float *restrict residual, int64_t begin, int64_t end, int64_t S) {
  UNUSED const int64_t R = PLANES * S;
#pragma omp simd
  for (int64_t j = begin; j < end; ++j) {
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
    residual_row(level->operator+ i * PLANES * S, level->right + i * V, level->solution + i * V, level->work + i * V, 0, S, S);
  wait_for(team);
}

/* The transposed interpolation of two rows where the rows were halved, with their weights. */
APART void gather_rows(const float *restrict low, const float *restrict high, float *restrict middle, int64_t count,
                       float below, float above) {
#pragma omp simd
  for (int64_t j = 0; j < count; ++j) middle[j] += below * low[j] + above * high[j];
}

/* The same along a row, where the columns were halved. */
APART void gather_columns(const float *restrict from, float *restrict to, int64_t fine_nj, int64_t nj, const int64_t *kept) {
  if (kept) {
    for (int64_t j = 0; j < nj; ++j) {
      to[j] = from[kept[j]];
      if (node_between(kept, j - 1, nj, fine_nj)) to[j] += 0.5f * from[kept[j] - 1];
      if (node_between(kept, j, nj, fine_nj)) to[j] += 0.5f * from[kept[j] + 1];
    }
    return;
  }
  const float last = 0.5f * (float)node_between(0, nj - 2, nj, fine_nj);
  to[0] = from[0] + (nj > 2 ? 0.5f : last) * from[1];
#pragma omp simd
  for (int64_t j = 1; j < nj - 2; ++j) to[j] = from[2 * j] + 0.5f * (from[2 * j - 1] + from[2 * j + 1]);
  if (nj > 2) to[nj - 2] = from[2 * (nj - 2)] + 0.5f * from[2 * nj - 5] + last * from[2 * nj - 3];
  to[nj - 1] = from[fine_nj - 1] + last * from[fine_nj - 2];
}

/* The coarse right-hand side is the transposed interpolation of the residual, which is changed. The last two coarse rows
 * or columns may be neighbors on the fine level. */
static void restrict_residual(const Level *fine, const Level *coarse, Team team) {
  const int64_t S = fine->stride, C = coarse->stride, ni = coarse->ni, nj = coarse->nj, *kept = coarse->kept_i;
  ROWS(coarse, team, i) {
    float *row = fine->work + 2 * S * fine_index(kept, i, ni, fine->ni), *to = coarse->right + 2 * C * i;
    const uint8_t *fixed = fixed_row(coarse, i);
    const float below = 0.5f * (float)node_between(kept, i - 1, ni, fine->ni);
    if (ni != fine->ni)
      gather_rows(row - 2 * S, row + 2 * S, row, 2 * S, below, 0.5f * (float)node_between(kept, i, ni, fine->ni));
    for (int c = 0; c < 2; ++c) {
      if (nj == fine->nj)
        memcpy(to + c * C, row + c * S, (size_t)nj * sizeof(float));
      else
        gather_columns(row + c * S, to + c * C, fine->nj, nj, coarse->kept_j);
      for (int64_t j = 0; j < nj; ++j) to[c * C + j] = fixed[j] ? 0.0f : to[c * C + j];
    }
  }
  wait_for(team);
}

/* Add to a fine row the mean of two coarse rows, interpolated along j where the columns were halved. */
APART void correct_row(const float *restrict low, const float *restrict high, float *restrict to,
                       const uint8_t *restrict fixed, int64_t nj, int64_t coarse_nj) {
  if (nj == coarse_nj) {
#pragma omp simd
    for (int64_t j = 0; j < nj; ++j) to[j] += fixed[j] ? 0.0f : 0.5f * (low[j] + high[j]);
    return;
  }
#pragma omp simd
  for (int64_t k = 0; k < nj / 2; ++k) to[2 * k] += fixed[2 * k] ? 0.0f : 0.5f * (low[k] + high[k]);
#pragma omp simd
  for (int64_t k = 0; k < (nj - 1) / 2; ++k)
    to[2 * k + 1] += fixed[2 * k + 1] ? 0.0f : 0.25f * (low[k] + low[k + 1] + high[k] + high[k + 1]);
  if (!fixed[nj - 1]) to[nj - 1] += 0.5f * (low[coarse_nj - 1] + high[coarse_nj - 1]);
}

/* The same for the columns of a list. */
static void correct_kept(const float *low, const float *high, float *to, const uint8_t *fixed, int64_t nj,
                         const Level *coarse) {
  const int64_t *kept = coarse->kept_j;
  for (int64_t k = 0; k < coarse->nj; ++k) {
    const int64_t j = kept[k];
    if (!fixed[j]) to[j] += 0.5f * (low[k] + high[k]);
    if (node_between(kept, k, coarse->nj, nj) && !fixed[j + 1])
      to[j + 1] += 0.25f * (low[k] + low[k + 1] + high[k] + high[k + 1]);
  }
}

/* Add the bilinear interpolation of the coarse solution. */
static void correct(const Level *coarse, const Level *fine, Team team) {
  const int64_t S = fine->stride, C = coarse->stride, ni = coarse->ni, last = ni - 1;
  for (int64_t k = share(ni, team.rank, team.size); k < share(ni, team.rank + 1, team.size); ++k) {
    const int64_t first = fine_index(coarse->kept_i, k, ni, fine->ni);
    const int64_t end = k == last ? fine->ni : fine_index(coarse->kept_i, k + 1, ni, fine->ni);
    for (int64_t i = first > fine->begin_i ? first : fine->begin_i; i < end && i < fine->end_i; ++i)
      for (int c = 0; c < 2; ++c) {
        const float *low = coarse->solution + (2 * k + c) * C, *high = i == first ? low : low + 2 * C;
        float *to = fine->solution + (2 * i + c) * S;
        if (coarse->kept_j)
          correct_kept(low, high, to, fixed_row(fine, i), fine->nj, coarse);
        else
          correct_row(low, high, to, fixed_row(fine, i), fine->nj, coarse->nj);
      }
  }
  wait_for(team);
}
