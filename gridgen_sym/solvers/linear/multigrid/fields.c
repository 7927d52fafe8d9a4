/* Fields as planes (2, ni, nj), and as vectors in double precision, whose rows lie as those of a level. */

/* From planes (2, ni, nj), zero at fixed nodes, to a vector. */
static void take_vector(const Level *level, Team team, const double *planes, double *restrict to) {
  ROWS(level, team, i)
    for (int c = 0; c < 2; ++c)
      memcpy(to + (2 * i + c) * level->stride, planes + (c * level->ni + i) * level->nj,
             (size_t)level->nj * sizeof(double));
}

/* And back, times a factor. */
static void give_vector(const Level *level, Team team, const double *vector, double *restrict planes, double factor) {
  const int64_t ni = level->ni, nj = level->nj;
  for (int64_t i = share(ni, team.rank, team.size); i < share(ni, team.rank + 1, team.size); ++i)
    for (int c = 0; c < 2; ++c) {
      const double *from = vector + (2 * i + c) * level->stride;
      double *to = planes + (c * ni + i) * nj;
      for (int64_t j = 0; j < nj; ++j) to[j] = factor * from[j];
    }
}
