/* One multigrid V-cycle for 9-point stencils of 2x2 blocks, and conjugate gradients preconditioned by it.
 *
 * Nothing here knows a functional: the stencil comes from a generated kernel. Compiled with GENERAL = 0 it is the
 * symmetric one of a Hessian, of which 19 planes are stored: the block of node (i, j) with itself (xx, xy, yy), then
 * those with (i+1, j), (i, j+1), (i+1, j+1), (i+1, j-1) (xx, xy, yx, yy each). With GENERAL = 1 it is that of the
 * Euler-Lagrange equations: nine blocks in the order (i-1, j-1), (i-1, j), ..., (i+1, j+1) (xx, xy, yx, yy each).
 *
 * The operator is in double precision, the cycle in single. Coarse operators are Galerkin's, with bilinear
 * interpolation, one direction at a time. Nodes on the edge are fixed.
 */
#include <math.h>
#include <stdint.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#if defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#define APART static __attribute__((noinline)) /* a loop that is inlined into another loses `restrict` */
#else
#define INLINE static inline
#define APART static
#endif

/* Nodes of a row are worked on in groups of CHUNK, an even number. */
enum { COARSEST_SWEEPS = 8, CHUNK = 128 };

/* One level: vectors have two planes, x and y. */
typedef struct {
  int64_t ni, nj, threads;
  float *operator; /* 19 or 36 planes */
  float *inverse;  /* 4 planes: inverse of the diagonal blocks */
  float *right, *solution, *residual;
  const uint8_t *fixed;
} Level;

/* Rows of the inside of a level, from `first` in steps, shared among its threads. */
#define PRAGMA(text) _Pragma(#text)
#define ROWS(level, first, step)                                                                              \
  PRAGMA(omp parallel for schedule(static) num_threads((int)(level)->threads))                                \
  for (int64_t i = (first); i < (level)->ni - 1; i += (step))

/* ---- coarse operators ---- */

#if GENERAL
/* Galerkin coarsening along i: coarse row I sits on fine row p, and a fine row between two coarse ones is the mean of
 * them. With M, U, D a row's couplings with itself, the next and the previous one, o the row between,
 * A_II = M_p + (U_p + D_o)/2 + M_o/4 + the same below, A_I,I+1 = (U_p + U_o)/2 + M_o/4, A_I,I-1 = (D_p + D_o)/2 + M_o/4.
 */
EXPORT void coarsen_rows(int64_t fine_ni, int64_t nj, const float *restrict fine, int64_t coarse_ni, float *restrict coarse,
                         int64_t threads) {
  const int64_t fp = fine_ni * nj, cp = coarse_ni * nj;
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t row = 0; row < coarse_ni; ++row) {
    const int64_t p = row < coarse_ni - 1 ? 2 * row : fine_ni - 1;
    const int64_t next = row + 1 < coarse_ni - 1 ? 2 * (row + 1) : fine_ni - 1;
    const int above = row + 1 < coarse_ni && next - p == 2, below = row > 0 && p - 2 * (row - 1) == 2;
    for (int part = 0; part < 12; ++part) {
      const float *down = fine + part * fp + p * nj, *middle = down + 12 * fp, *up = down + 24 * fp;
      float *to = coarse + part * cp + row * nj;
      for (int64_t j = 0; j < nj; ++j) {
        float self = middle[j], forth = up[j], back = down[j];
        if (above) {
          self += 0.5f * (up[j] + down[nj + j]) + 0.25f * middle[nj + j];
          forth = 0.5f * (forth + up[nj + j]) + 0.25f * middle[nj + j];
        }
        if (below) {
          self += 0.5f * (down[j] + up[j - nj]) + 0.25f * middle[j - nj];
          back = 0.5f * (back + down[j - nj]) + 0.25f * middle[j - nj];
        }
        to[j] = back, to[12 * cp + j] = self, to[24 * cp + j] = forth;
      }
    }
  }
}

/* The same along j: coarse column J sits on fine column 2 J, the last one on the last. */
EXPORT void coarsen_columns(int64_t ni, int64_t fine_nj, const float *restrict fine, int64_t coarse_nj,
                            float *restrict coarse, int64_t threads) {
  const int64_t fp = ni * fine_nj, cp = ni * coarse_nj;
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t i = 0; i < ni; ++i)
    for (int row = 0; row < 3; ++row)
      for (int e = 0; e < 4; ++e) {
        const float *left = fine + (12 * row + e) * fp + i * fine_nj, *middle = left + 4 * fp, *right = left + 8 * fp;
        float *to = coarse + (12 * row + e) * cp + i * coarse_nj;
        for (int64_t column = 0; column < coarse_nj; ++column) {
          const int64_t q = column < coarse_nj - 1 ? 2 * column : fine_nj - 1;
          const int64_t next = column + 1 < coarse_nj - 1 ? 2 * (column + 1) : fine_nj - 1;
          const int above = column + 1 < coarse_nj && next - q == 2, below = column > 0 && q - 2 * (column - 1) == 2;
          float self = middle[q], forth = right[q], back = left[q];
          if (above) {
            self += 0.5f * (right[q] + left[q + 1]) + 0.25f * middle[q + 1];
            forth = 0.5f * (forth + right[q + 1]) + 0.25f * middle[q + 1];
          }
          if (below) {
            self += 0.5f * (left[q] + right[q - 1]) + 0.25f * middle[q - 1];
            back = 0.5f * (back + left[q - 1]) + 0.25f * middle[q - 1];
          }
          to[column] = back, to[4 * cp + column] = self, to[8 * cp + column] = forth;
        }
      }
}

/* Take fixed nodes out of a stencil: their own blocks, and the couplings with them. */
EXPORT void decouple(int64_t ni, int64_t nj, double *planes, const uint8_t *fixed) {
  const int64_t plane = ni * nj;
  for (int64_t i = 0; i < ni; ++i)
    for (int64_t j = 0; j < nj; ++j) {
      const int64_t n = i * nj + j;
      for (int k = 0; k < 9; ++k) {
        const int64_t ki = i + k / 3 - 1, kj = j + k % 3 - 1;
        const int outside = ki < 0 || ki >= ni || kj < 0 || kj >= nj;
        if (fixed[n] || outside || fixed[ki * nj + kj])
          for (int e = 0; e < 4; ++e) planes[(4 * k + e) * plane + n] = 0.0;
      }
    }
}

#else
/* Transposed entry of a block stored as xx, xy, yx, yy. */
static const int transposed[4] = {0, 2, 1, 3};

/* Galerkin coarsening along i: coarse row I sits on fine row `row[I]`; a fine row between two coarse ones is the mean
 * of them. A_II = S_p + (N_p + N_p')/2 + (N_o + N_o')/2 + (S_o + S_o+)/4 and A_I,I+1 = (N_p + N_o)/2 + S_o/4, where S is
 * a row's coupling with itself, N that with the next row, o the row between. */
EXPORT void coarsen_rows(int64_t fine_ni, int64_t nj, const float *restrict fine, int64_t coarse_ni, float *restrict coarse,
                         int64_t threads) {
  const int64_t fp = fine_ni * nj, cp = coarse_ni * nj;
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t row = 0; row < coarse_ni; ++row) {
    const int64_t p = row < coarse_ni - 1 ? 2 * row : fine_ni - 1;
    const int64_t next = row + 1 < coarse_ni - 1 ? 2 * (row + 1) : fine_ni - 1;
    const int above = row + 1 < coarse_ni && next - p == 2;       /* a row between this one and the next */
    const int below = row > 0 && p - 2 * (row - 1) == 2;          /* and between the one before and this */
    const float *a = fine + p * nj;
    float *c = coarse + row * nj;
    for (int e = 0; e < 3; ++e) {
      const int xy = e == 0 ? 0 : e == 1 ? 1 : 3, yx = transposed[xy];
      for (int64_t j = 0; j < nj; ++j) {
        float sum = a[e * fp + j];
        if (above) sum += 0.5f * (a[(3 + xy) * fp + j] + a[(3 + yx) * fp + j]) + 0.25f * a[e * fp + nj + j];
        if (below) sum += 0.5f * (a[(3 + xy) * fp - nj + j] + a[(3 + yx) * fp - nj + j]) + 0.25f * a[e * fp - nj + j];
        c[e * cp + j] = sum;
      }
    }
    for (int e = 0; e < 4; ++e) {
      const int t = transposed[e];
      const int s = e == 0 ? 0 : e == 3 ? 2 : 1; /* the stored entry of a symmetric diagonal block */
      for (int64_t j = 0; j < nj; ++j) {
        const int64_t left = j > 0 ? j - 1 : 0, right = j < nj - 1 ? j + 1 : j;
        const float inside = j < nj - 1 ? 1.0f : 0.0f, inside_left = j > 0 ? 1.0f : 0.0f;
        float along = a[(7 + e) * fp + j];
        if (above)
          along += inside * 0.5f * (a[(11 + e) * fp + j] + a[(15 + t) * fp + right]) + 0.25f * a[(7 + e) * fp + nj + j];
        if (below)
          along += inside * 0.5f * (a[(11 + e) * fp - nj + j] + a[(15 + t) * fp - nj + right]) + 0.25f * a[(7 + e) * fp - nj + j];
        c[(7 + e) * cp + j] = along;
        float up = a[(3 + e) * fp + j], up_right = a[(11 + e) * fp + j], up_left = a[(15 + e) * fp + j];
        if (above) {
          up = 0.5f * (up + a[(3 + e) * fp + nj + j]) + 0.25f * a[s * fp + nj + j];
          up_right = 0.5f * (up_right + a[(11 + e) * fp + nj + j]) + 0.25f * a[(7 + e) * fp + nj + j];
          up_left = 0.5f * (up_left + a[(15 + e) * fp + nj + j]) + 0.25f * inside_left * a[(7 + t) * fp + nj + left];
        }
        c[(3 + e) * cp + j] = up, c[(11 + e) * cp + j] = up_right, c[(15 + e) * cp + j] = up_left;
      }
    }
  }
}

/* The same along j: coarse column J sits on fine column 2 J, the last one on the last. */
EXPORT void coarsen_columns(int64_t ni, int64_t fine_nj, const float *restrict fine, int64_t coarse_nj,
                            float *restrict coarse, int64_t threads) {
  const int64_t fp = ni * fine_nj, cp = ni * coarse_nj;
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t i = 0; i < ni; ++i)
    for (int64_t column = 0; column < coarse_nj; ++column) {
      const int64_t q = column < coarse_nj - 1 ? 2 * column : fine_nj - 1;
      const int64_t next = column + 1 < coarse_nj - 1 ? 2 * (column + 1) : fine_nj - 1;
      const int above = column + 1 < coarse_nj && next - q == 2, below = column > 0 && q - 2 * (column - 1) == 2;
      const float *a = fine + i * fine_nj + q;
      float *c = coarse + i * coarse_nj + column;
      for (int e = 0; e < 3; ++e) {
        const int xy = e == 0 ? 0 : e == 1 ? 1 : 3, yx = transposed[xy];
        float sum = a[e * fp];
        if (above) sum += 0.5f * (a[(7 + xy) * fp] + a[(7 + yx) * fp]) + 0.25f * a[e * fp + 1];
        if (below) sum += 0.5f * (a[(7 + xy) * fp - 1] + a[(7 + yx) * fp - 1]) + 0.25f * a[e * fp - 1];
        c[e * cp] = sum;
      }
      for (int e = 0; e < 4; ++e) {
        const int s = e == 0 ? 0 : e == 3 ? 2 : 1;
        const float up_row = i + 1 < ni ? 1.0f : 0.0f;
        /* From (i, q) to (i+1, q), collected over the columns that belong to this coarse one. */
        float up = a[(3 + e) * fp];
        if (above) up += 0.5f * (a[(11 + e) * fp] + a[(15 + e) * fp + 1]) + 0.25f * a[(3 + e) * fp + 1];
        if (below) up += 0.5f * (a[(11 + e) * fp - 1] + a[(15 + e) * fp]) + 0.25f * a[(3 + e) * fp - 1];
        c[(3 + e) * cp] = up_row * up;
        /* To the next column: (0, 1) and (1, 1); (1, -1) goes to the column before. */
        float along = a[(7 + e) * fp], up_right = a[(11 + e) * fp], up_left = a[(15 + e) * fp];
        if (above) {
          along = 0.5f * (along + a[(7 + e) * fp + 1]) + 0.25f * a[s * fp + 1];
          up_right = 0.5f * (up_right + a[(11 + e) * fp + 1]) + 0.25f * a[(3 + e) * fp + 1];
        }
        if (below) up_left = 0.5f * (up_left + a[(15 + e) * fp - 1]) + 0.25f * a[(3 + e) * fp - 1];
        c[(7 + e) * cp] = along, c[(11 + e) * cp] = up_row * up_right, c[(15 + e) * cp] = up_row * up_left;
      }
    }
}

/* Take fixed nodes out of a stencil: their own blocks, and the couplings with them. */
EXPORT void decouple(int64_t ni, int64_t nj, double *planes, const uint8_t *fixed) {
  const int64_t plane = ni * nj;
  static const int di[4] = {1, 0, 1, 1}, dj[4] = {0, 1, 1, -1};
  for (int64_t i = 0; i < ni; ++i)
    for (int64_t j = 0; j < nj; ++j) {
      const int64_t n = i * nj + j;
      if (fixed[n]) planes[n] = planes[plane + n] = planes[2 * plane + n] = 0.0;
      for (int k = 0; k < 4; ++k) {
        const int64_t ki = i + di[k], kj = j + dj[k];
        const int outside = ki >= ni || kj < 0 || kj >= nj;
        if (fixed[n] || outside || fixed[ki * nj + kj])
          for (int e = 0; e < 4; ++e) planes[(3 + 4 * k + e) * plane + n] = 0.0;
      }
    }
}

#endif

/* Copy planes to single precision, times a factor. */
EXPORT void to_single(int64_t count, const double *restrict from, float *restrict to, double factor, int64_t threads) {
#pragma omp parallel for simd schedule(static) num_threads((int)threads)
  for (int64_t n = 0; n < count; ++n) to[n] = (float)(factor * from[n]);
}

/* The diagonal block of node n. */
#if GENERAL
#define BLOCK(a, entry) (a)[(16 + (entry)) * plane + n]
#else
#define BLOCK(a, entry) (a)[((entry) == 3 ? 2 : (entry) == 0 ? 0 : 1) * plane + n]
#endif

/* Invert the diagonal blocks; returns how many cannot be, or in a symmetric stencil are not positive definite. */
EXPORT int64_t invert_diagonal(Level *level) {
  const int64_t plane = level->ni * level->nj;
  const float *a = level->operator;
  int64_t unusable = 0;
  for (int64_t n = 0; n < plane; ++n) {
    const float xx = BLOCK(a, 0), xy = BLOCK(a, 1), yx = BLOCK(a, 2), yy = BLOCK(a, 3), determinant = xx * yy - xy * yx;
#if GENERAL
    const int usable = fabsf(determinant) > 1e-7f * (fabsf(xx * yy) + fabsf(xy * yx));
#else
    const int usable = xx > 0.0f && determinant > 1e-7f * xx * yy;
#endif
    unusable += !usable && !level->fixed[n];
    const float scale = usable && !level->fixed[n] ? 1.0f / determinant : 0.0f;
    level->inverse[n] = scale * yy, level->inverse[plane + n] = -scale * xy;
    level->inverse[2 * plane + n] = -scale * yx, level->inverse[3 * plane + n] = scale * xx;
  }
  return unusable;
}

/* ---- stencil times vector ---- */

/* Sum of the couplings of node n with its 8 neighbors. */
#if GENERAL
#define NEIGHBORS(COEFFICIENT, REAL, a, x, y, sx, sy)                                                                       \
  REAL sx = 0, sy = 0;                                                                                          \
  for (int k = 0; k < 9; ++k) {                                                                                 \
    const int64_t to = n + (k / 3 - 1) * nj + k % 3 - 1;                                                        \
    const COEFFICIENT *restrict b = (a) + 4 * k * plane;                                                               \
    if (k != 4) {                                                                                               \
      sx += b[n] * (x)[to] + b[plane + n] * (y)[to];                                                            \
      sy += b[2 * plane + n] * (x)[to] + b[3 * plane + n] * (y)[to];                                            \
    }                                                                                                           \
  }
#else
#define NEIGHBORS(COEFFICIENT, REAL, a, x, y, sx, sy)                                                                       \
  REAL sx = 0, sy = 0;                                                                                          \
  {                                                                                                             \
    const int64_t offsets[4] = {nj, 1, nj + 1, nj - 1};                                                         \
    for (int k = 0; k < 4; ++k) {                                                                               \
      const COEFFICIENT *restrict b = (a) + (3 + 4 * k) * plane;                                                       \
      const int64_t to = n + offsets[k], from = n - offsets[k];                                                 \
      sx += b[n] * (x)[to] + b[plane + n] * (y)[to] + b[from] * (x)[from] + b[2 * plane + from] * (y)[from];    \
      sy += b[2 * plane + n] * (x)[to] + b[3 * plane + n] * (y)[to] + b[plane + from] * (x)[from] +             \
            b[3 * plane + from] * (y)[from];                                                                    \
    }                                                                                                           \
  }
#endif

/* The symmetric operator is that of the preconditioner, in single precision: half of the memory to read, and Newton's
 * method needs no better. The other one keeps double precision. */
#if GENERAL
typedef double COEFFICIENT;
#else
typedef float COEFFICIENT;
#endif

/* result = A vector at the inner nodes, and per row the product of the two. */
static void multiply(const Level *level, const COEFFICIENT *restrict a, const double *restrict v, double *restrict result,
                     double *restrict row_product) {
  const int64_t nj = level->nj, plane = level->ni * nj;
  const double *restrict x = v, *restrict y = v + plane;
  ROWS(level, 1, 1) {
    double product = 0.0;
#pragma omp simd reduction(+ : product)
    for (int64_t j = 1; j < nj - 1; ++j) {
      const int64_t n = i * nj + j;
      NEIGHBORS(COEFFICIENT, double, a, x, y, sx, sy)
      const double rx = sx + BLOCK(a, 0) * x[n] + BLOCK(a, 1) * y[n];
      const double ry = sy + BLOCK(a, 2) * x[n] + BLOCK(a, 3) * y[n];
      result[n] = rx, result[plane + n] = ry;
      product += x[n] * rx + y[n] * ry;
    }
    row_product[i] = product;
  }
}

/* ---- one V-cycle ---- */

/* Gauss-Seidel values of a group of nodes of a row. */
APART void relaxed_values(const float *restrict a, const float *restrict inverse, const float *restrict right,
                          const float *restrict x, const float *restrict y, int64_t nj, int64_t plane, int64_t begin,
                          int64_t count, float *restrict to_x, float *restrict to_y) {
#pragma omp simd
  for (int64_t k = 0; k < count; ++k) {
    const int64_t n = begin + k;
    NEIGHBORS(float, float, a, x, y, sx, sy)
    const float rx = right[n] - sx, ry = right[plane + n] - sy;
    to_x[k] = inverse[n] * rx + inverse[plane + n] * ry;
    to_y[k] = inverse[2 * plane + n] * rx + inverse[3 * plane + n] * ry;
  }
}

/* Gauss-Seidel at every second node of a row. All nodes are computed and every second one is kept: with unit stride this
 * is several times faster than visiting every second node. */
static void smooth_row(const Level *level, int64_t i, int64_t parity) {
  const int64_t nj = level->nj, plane = level->ni * nj;
  float *x = level->solution, *y = level->solution + plane, new_x[CHUNK], new_y[CHUNK];
  for (int64_t j = 1; j < nj - 1; j += CHUNK) {
    const int64_t begin = i * nj + j, count = nj - 1 - j < CHUNK ? nj - 1 - j : CHUNK;
    relaxed_values(level->operator, level->inverse, level->right, x, y, nj, plane, begin, count, new_x, new_y);
    /* CHUNK is even and j odd, so node j + k has parity 1 + k. */
    for (int64_t k = 1 - parity; k < count; k += 2) x[begin + k] = new_x[k], y[begin + k] = new_y[k];
  }
}

static void smooth_colors_of_row(const Level *level, int64_t i, int backwards) {
  smooth_row(level, i, backwards ? 0 : 1);
  smooth_row(level, i, backwards ? 1 : 0);
}

/* Four colors forwards, or backwards: the two together are a symmetric preconditioner. Every second row goes first, and
 * the row between two of them follows as soon as both are done, while the operator's rows are still in the cache. At the
 * ends of a thread's band it waits for the other threads. */
static void smooth(const Level *level, int backwards) {
  const int64_t rows = level->ni - 2, ahead = backwards ? 0 : 1;
#pragma omp parallel num_threads((int)level->threads)
  {
#ifdef _OPENMP
    const int64_t thread = omp_get_thread_num(), threads = omp_get_num_threads();
#else
    const int64_t thread = 0, threads = 1;
#endif
    const int64_t first = 1 + rows * thread / threads, last = 1 + rows * (thread + 1) / threads;
    for (int64_t i = first; i < last; ++i) {
      if (i % 2 != ahead) continue;
      smooth_colors_of_row(level, i, backwards);
      if (i - 1 > first) smooth_colors_of_row(level, i - 1, backwards);
    }
#pragma omp barrier
    if (first < last && first % 2 != ahead) smooth_colors_of_row(level, first, backwards);
    if (first < last - 1 && (last - 1) % 2 != ahead) smooth_colors_of_row(level, last - 1, backwards);
  }
}

static void compute_residual(const Level *level) {
  const int64_t nj = level->nj, plane = level->ni * nj;
  const float *restrict a = level->operator, *restrict right = level->right;
  const float *restrict x = level->solution, *restrict y = level->solution + plane;
  float *restrict residual = level->residual;
  ROWS(level, 1, 1) {
#pragma omp simd
    for (int64_t j = 1; j < nj - 1; ++j) {
      const int64_t n = i * nj + j;
      NEIGHBORS(float, float, a, x, y, sx, sy)
      residual[n] = right[n] - sx - BLOCK(a, 0) * x[n] - BLOCK(a, 1) * y[n];
      residual[plane + n] = right[plane + n] - sy - BLOCK(a, 2) * x[n] - BLOCK(a, 3) * y[n];
    }
  }
}

/* Fine index of a coarse one, and whether a fine node lies between it and the next. */
INLINE int64_t fine_index(int64_t coarse, int64_t coarse_count, int64_t fine_count) {
  if (coarse_count == fine_count) return coarse;
  return coarse < coarse_count - 1 ? 2 * coarse : fine_count - 1;
}

/* The coarse right-hand side is the transposed interpolation of the residual. */
static void restrict_residual(const Level *fine, const Level *coarse) {
  const int64_t fp = fine->ni * fine->nj, cp = coarse->ni * coarse->nj;
  ROWS(coarse, 1, 1) {
    const int64_t p = fine_index(i, coarse->ni, fine->ni);
    const float below = p - fine_index(i - 1, coarse->ni, fine->ni) == 2 ? 0.5f : 0.0f;
    const float above = fine_index(i + 1, coarse->ni, fine->ni) - p == 2 ? 0.5f : 0.0f;
    for (int64_t j = 1; j < coarse->nj - 1; ++j) {
      const int64_t q = fine_index(j, coarse->nj, fine->nj), n = i * coarse->nj + j;
      const float left = q - fine_index(j - 1, coarse->nj, fine->nj) == 2 ? 0.5f : 0.0f;
      const float right = fine_index(j + 1, coarse->nj, fine->nj) - q == 2 ? 0.5f : 0.0f;
      for (int c = 0; c < 2; ++c) {
        const float *r = fine->residual + c * fp + p * fine->nj + q, *down = r - fine->nj, *up = r + fine->nj;
        const float middle = r[0] + left * r[-1] + right * r[1];
        const float lower = down[0] + left * down[-1] + right * down[1], upper = up[0] + left * up[-1] + right * up[1];
        coarse->right[c * cp + n] = coarse->fixed[n] ? 0.0f : middle + below * lower + above * upper;
        coarse->solution[c * cp + n] = 0.0f;
      }
    }
  }
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
static void correct(const Level *coarse, const Level *fine) {
  const int64_t fp = fine->ni * fine->nj, cp = coarse->ni * coarse->nj;
  const int halve_i = coarse->ni != fine->ni, halve_j = coarse->nj != fine->nj;
  ROWS(fine, 1, 1) {
    const int64_t low = halve_i ? i / 2 : i, high = halve_i ? low + (i % 2) : i;
    for (int c = 0; c < 2; ++c)
      correct_row(coarse->solution + c * cp + low * coarse->nj, coarse->solution + c * cp + high * coarse->nj,
                  fine->solution + c * fp + i * fine->nj, fine->fixed + i * fine->nj, fine->nj, halve_j);
  }
}

static void v_cycle(Level *levels, int64_t count) {
  if (count == 1) {
    for (int sweep = 0; sweep < COARSEST_SWEEPS; ++sweep) smooth(levels, 0), smooth(levels, 1);
    return;
  }
  smooth(levels, 0);
  compute_residual(levels);
  restrict_residual(levels, levels + 1);
  v_cycle(levels + 1, count - 1);
  correct(levels + 1, levels);
  smooth(levels, 1);
}

/* ---- conjugate gradients ---- */

static double sum_rows(const Level *level, const double *row) {
  double sum = 0.0;
  for (int64_t i = 1; i < level->ni - 1; ++i) sum += row[i];
  return sum;
}

/* z = V-cycle(r); returns z.r */
static double precondition(Level *levels, int64_t count, const double *restrict r, double *restrict z, double scale,
                           double *restrict row) {
  Level *level = levels;
  const int64_t nj = level->nj, plane = level->ni * nj;
  ROWS(level, 1, 1)
    for (int c = 0; c < 2; ++c)
      for (int64_t n = c * plane + i * nj + 1; n < c * plane + i * nj + nj - 1; ++n)
        level->right[n] = (float)(scale * r[n]), level->solution[n] = 0.0f;
  v_cycle(levels, count);
  ROWS(level, 1, 1) {
    double product = 0.0;
    for (int c = 0; c < 2; ++c)
      for (int64_t n = c * plane + i * nj + 1; n < c * plane + i * nj + nj - 1; ++n)
        z[n] = (double)level->solution[n], product += z[n] * r[n];
    row[i] = product;
  }
  return sum_rows(level, row);
}

#if !GENERAL
/* Solve A solution = right to a relative residual, A being the finest level's; vectors are zero at fixed nodes.
 * work has 4 vectors of 2 planes, then ni numbers. Returns the number of iterations, negative if a direction of
 * negative curvature was met (the solution is then the iterate before it, or the right-hand side at the first). */
EXPORT int64_t conjugate_gradients(Level *levels, int64_t count, const double *right, double *solution, double *work,
                                   double tolerance, int64_t limit, double *reduction) {
  const Level *level = levels;
  const int64_t nj = level->nj, plane = level->ni * nj;
  double *r = work, *z = work + 2 * plane, *p = work + 4 * plane, *q = work + 6 * plane, *row = work + 8 * plane;
  for (int64_t n = 0; n < 2 * plane; ++n) solution[n] = 0.0, r[n] = right[n], z[n] = p[n] = q[n] = 0.0;
  double norm = 0.0;
  for (int64_t n = 0; n < 2 * plane; ++n) norm += r[n] * r[n];
  const double first = norm;
  const double scale = norm > 0.0 ? 1.0 / sqrt(norm / (double)plane) : 1.0; /* keeps single precision in range */
  double product = precondition(levels, count, r, z, scale, row), previous = 0.0;
  int64_t iteration = 0;
  while (iteration < limit && norm > tolerance * tolerance * first) {
    const double beta = iteration == 0 ? 0.0 : product / previous;
    ROWS(level, 1, 1)
      for (int c = 0; c < 2; ++c)
        for (int64_t n = c * plane + i * nj + 1; n < c * plane + i * nj + nj - 1; ++n) p[n] = z[n] + beta * p[n];
    multiply(level, level->operator, p, q, row);
    const double curvature = sum_rows(level, row);
    ++iteration;
    if (!(curvature > 0.0) || !(product > 0.0)) {
      if (iteration == 1)
        for (int64_t n = 0; n < 2 * plane; ++n) solution[n] = right[n];
      *reduction = sqrt(norm / first);
      return -iteration;
    }
    const double alpha = product / curvature;
    ROWS(level, 1, 1) {
      double sum = 0.0;
      for (int c = 0; c < 2; ++c)
#pragma omp simd reduction(+ : sum)
        for (int64_t n = c * plane + i * nj + 1; n < c * plane + i * nj + nj - 1; ++n) {
          solution[n] += alpha * p[n];
          r[n] -= alpha * q[n];
          sum += r[n] * r[n];
        }
      row[i] = sum;
    }
    norm = sum_rows(level, row);
    if (!(norm > tolerance * tolerance * first)) break;
    previous = product;
    product = precondition(levels, count, r, z, scale, row);
  }
  *reduction = first > 0.0 ? sqrt(norm / first) : 0.0;
  return iteration;
}

#else

/* ---- for a Krylov method outside ---- */

/* result = A vector; row has ni numbers. */
EXPORT void apply_operator(const Level *level, const double *operator, const double *vector, double *result, double *row) {
  multiply(level, operator, vector, result, row);
}

/* result = V-cycle(vector); row has ni numbers. */
EXPORT void apply_cycle(Level *levels, int64_t count, const double *vector, double *result, double *row) {
  const int64_t plane = levels->ni * levels->nj;
  double norm = 0.0;
  for (int64_t n = 0; n < 2 * plane; ++n) norm += vector[n] * vector[n];
  const double scale = norm > 0.0 ? 1.0 / sqrt(norm / (double)plane) : 1.0; /* keeps single precision in range */
  precondition(levels, count, vector, result, scale, row);
  for (int64_t n = 0; n < 2 * plane; ++n) result[n] /= scale;
}
#endif
