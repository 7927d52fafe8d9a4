/* Products of vectors in double precision with the finest operator. */

/* result = A vector for a row, from column `begin` to `end`; returns the product of `with` and the result. To a whole row,
 * which takes fewer instructions, the last number would come from the next entry's first: it belongs to the margin. */
#define MULTIPLY_ROW(name, REAL)                                                                                    \
  APART double name(const float *restrict a, const REAL *restrict x, const double *restrict with,                   \
                    double *restrict result, int64_t begin, int64_t end, int64_t S) {                               \
    UNUSED const int64_t R = PLANES * S;                                                                            \
    double product = 0.0;                                                                                           \
    PRAGMA(omp simd reduction(+ : product))                                                                         \
    for (int64_t j = begin; j < end; ++j) {                                                                         \
      double sx = OWN(a, 0) * (double)x[j] + OWN(a, 1) * (double)x[S + j];                                          \
      double sy = OWN(a, 2) * (double)x[j] + OWN(a, 3) * (double)x[S + j];                                          \
      COUPLE(0, 1, 0)                                                                                               \
      COUPLE(1, 0, 1)                                                                                               \
      COUPLE(2, 1, 1)                                                                                               \
      COUPLE(3, 1, -1)                                                                                              \
      result[j] = sx, result[S + j] = sy;                                                                           \
      product += with[j] * sx + with[S + j] * sy;                                                                   \
    }                                                                                                               \
    result[S - 1] = result[2 * S - 1] = 0.0;                                                                        \
    return product;                                                                                                 \
  }
