/* What Krylov's methods share: vectors in double precision, and their products with the finest operator. */

/* Zero everywhere, and so for good at the boundary and where rows are longer than the grid. */
static void clear_vector(const Level *level, Team team, double *vector) {
  const int64_t width = 2 * level->stride;
  for (int64_t i = share(level->ni, team.rank, team.size); i < share(level->ni, team.rank + 1, team.size); ++i)
    memset(vector + i * width, 0, (size_t)width * sizeof(double));
}

/* From planes (2, ni, nj) to a vector, at the inner nodes. */
static void take_vector(const Level *level, Team team, const double *planes, double *restrict to) {
  ROWS(level, team, i)
    for (int c = 0; c < 2; ++c)
      memcpy(to + (2 * i + c) * level->stride + 1, planes + (c * level->ni + i) * level->nj + 1,
             (size_t)(level->nj - 2) * sizeof(double));
}

/* And back, times a factor; zero at the boundary. */
static void give_vector(const Level *level, Team team, const double *vector, double *restrict planes, double factor) {
  const int64_t ni = level->ni, nj = level->nj;
  for (int64_t i = share(ni, team.rank, team.size); i < share(ni, team.rank + 1, team.size); ++i)
    for (int c = 0; c < 2; ++c) {
      const double *from = vector + (2 * i + c) * level->stride;
      double *to = planes + (c * ni + i) * nj;
      for (int64_t j = 0; j < nj; ++j) to[j] = i % (ni - 1) == 0 || j % (nj - 1) == 0 ? 0.0 : factor * from[j];
    }
}

/* The sum of what all threads have put into `row`, one number for each row: the same for any number of threads. */
static double total(const Level *level, Team team, const double *row) {
  wait_for(team);
  double sum = 0.0;
  for (int64_t i = 1; i < level->ni - 1; ++i) sum += row[i];
  return sum;
}

/* result = A vector for a row, at the inner nodes; returns the product of `with` and the result. */
#define MULTIPLY_ROW(name, REAL)                                                                                    \
  APART double name(const float *restrict a, const REAL *restrict x, const double *restrict with,                   \
                    double *restrict result, int64_t nj, int64_t S) {                                               \
    UNUSED const int64_t R = PLANES * S;                                                                            \
    double product = 0.0;                                                                                           \
    PRAGMA(omp simd reduction(+ : product))                                                                         \
    for (int64_t j = 1; j < nj - 1; ++j) {                                                                          \
      double sx = OWN(a, 0) * (double)x[j] + OWN(a, 1) * (double)x[S + j];                                          \
      double sy = OWN(a, 2) * (double)x[j] + OWN(a, 3) * (double)x[S + j];                                          \
      COUPLE(0, 1, 0)                                                                                               \
      COUPLE(1, 0, 1)                                                                                               \
      COUPLE(2, 1, 1)                                                                                               \
      COUPLE(3, 1, -1)                                                                                              \
      result[j] = sx, result[S + j] = sy;                                                                           \
      product += with[j] * sx + with[S + j] * sy;                                                                   \
    }                                                                                                               \
    return product;                                                                                                 \
  }
