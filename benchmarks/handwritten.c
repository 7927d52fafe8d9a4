/* The Winslow functional by hand: sum over the four corners of every cell of (g11 + g22)/J, its gradient, and its Hessian
 * times a vector.
 *
 * The yardstick of the generated kernels: the same layout (planes x and y, rows of nj nodes), the same results (energy
 * and smallest Jacobian per row of cells, gradient of all nodes), but the four corners of a cell written as one formula.
 */
#include <math.h>
#include <stdint.h>

#define EXPORT __attribute__((visibility("default")))
#define APART static __attribute__((noinline)) /* keeps `restrict` */

enum { CHUNK = 64 };

/* Edges of the cell whose first node is n: a0, a1 along i (at j and j+1), b0, b1 along j (at i and i+1). */
#define CELL                                                                                                    \
  const double a0x = x[n + nj] - x[n], a0y = y[n + nj] - y[n];                                                  \
  const double b0x = x[n + 1] - x[n], b0y = y[n + 1] - y[n];                                                    \
  const double a1x = x[n + nj + 1] - x[n + 1], a1y = y[n + nj + 1] - y[n + 1];                                  \
  const double b1x = x[n + nj + 1] - x[n + nj], b1y = y[n + nj + 1] - y[n + nj];                                \
  const double A0 = a0x * a0x + a0y * a0y, A1 = a1x * a1x + a1y * a1y;                                          \
  const double B0 = b0x * b0x + b0y * b0y, B1 = b1x * b1x + b1y * b1y;                                          \
  const double J00 = a0x * b0y - a0y * b0x, J10 = a0x * b1y - a0y * b1x;                                        \
  const double J01 = a1x * b0y - a1y * b0x, J11 = a1x * b1y - a1y * b1x;                                        \
  const double low = J00 < J10 ? J00 : J10, high = J01 < J11 ? J01 : J11, lower = low < high ? low : high;

EXPORT void winslow_energy(int64_t ni, int64_t nj, const double *restrict x, const double *restrict y,
                           double *restrict row_energy, double *restrict row_smallest, int64_t threads) {
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t i = 0; i < ni - 1; ++i) {
    double energy = 0.0, smallest = INFINITY;
#pragma omp simd reduction(+ : energy) reduction(min : smallest)
    for (int64_t n = i * nj; n < i * nj + nj - 1; ++n) {
      CELL
      energy += (A0 + B0) / J00 + (A0 + B1) / J10 + ((A1 + B0) / J01 + (A1 + B1) / J11);
      smallest = lower < smallest ? lower : smallest;
    }
    row_energy[i] = energy, row_smallest[i] = smallest;
  }
}

/* Derivatives of a group of cells in their nodes (i,j), (i+1,j), (i,j+1), (i+1,j+1), x and y, kept from place 1 on. */
typedef double Cells[8][CHUNK + 1];

APART void cell_derivatives(int64_t begin, int64_t count, int64_t nj, const double *restrict x, const double *restrict y,
                            double (*restrict f)[CHUNK + 1], double *energy, double *smallest) {
  double sum = 0.0, least = INFINITY;
#pragma omp simd reduction(+ : sum) reduction(min : least)
  for (int64_t k = 0; k < count; ++k) {
    const int64_t n = begin + k;
    CELL
    const double r00 = 1.0 / J00, r10 = 1.0 / J10, r01 = 1.0 / J01, r11 = 1.0 / J11;
    const double e00 = (A0 + B0) * r00, e10 = (A0 + B1) * r10, e01 = (A1 + B0) * r01, e11 = (A1 + B1) * r11;
    const double t00 = e00 * r00, t10 = e10 * r10, t01 = e01 * r01, t11 = e11 * r11;
    const double ra0 = 2.0 * (r00 + r10), ra1 = 2.0 * (r01 + r11), rb0 = 2.0 * (r00 + r01), rb1 = 2.0 * (r10 + r11);
    const double da0x = ra0 * a0x - t00 * b0y - t10 * b1y, da0y = ra0 * a0y + t00 * b0x + t10 * b1x;
    const double da1x = ra1 * a1x - t01 * b0y - t11 * b1y, da1y = ra1 * a1y + t01 * b0x + t11 * b1x;
    const double db0x = rb0 * b0x + t00 * a0y + t01 * a1y, db0y = rb0 * b0y - t00 * a0x - t01 * a1x;
    const double db1x = rb1 * b1x + t10 * a0y + t11 * a1y, db1y = rb1 * b1y - t10 * a0x - t11 * a1x;
    f[0][k + 1] = -da0x - db0x, f[1][k + 1] = -da0y - db0y, f[2][k + 1] = da0x - db1x, f[3][k + 1] = da0y - db1y;
    f[4][k + 1] = db0x - da1x, f[5][k + 1] = db0y - da1y, f[6][k + 1] = da1x + db1x, f[7][k + 1] = da1y + db1y;
    sum += (e00 + e10) + (e01 + e11);
    least = lower < least ? lower : least;
  }
  *energy += sum;
  *smallest = least < *smallest ? least : *smallest;
}

/* A row of nodes takes `here` of its own cell and `left` of the cell before. */
static inline void gather(double *restrict row, const double *restrict here, const double *restrict left, int64_t count,
                          int add) {
  if (add) {
#pragma omp simd
    for (int64_t k = 0; k < count; ++k) row[k] += here[k + 1] + left[k];
  } else {
#pragma omp simd
    for (int64_t k = 0; k < count; ++k) row[k] = here[k + 1] + left[k];
  }
}

/* The row of cells i adds to the rows of nodes i and i+1; a share of rows begins with the row of cells below it. */
EXPORT void winslow_energy_gradient(int64_t ni, int64_t nj, const double *restrict x, const double *restrict y,
                                    double *restrict row_energy, double *restrict row_smallest,
                                    double *restrict gradient, int64_t threads) {
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t share = 0; share < threads; ++share) {
    const int64_t first = ni * share / threads, last = ni * (share + 1) / threads;
    for (int64_t i = first > 0 ? first - 1 : 0; i < last && i < ni - 1; ++i) {
      Cells f;
      double energy = 0.0, smallest = INFINITY;
      for (int part = 0; part < 8; ++part) f[part][0] = 0.0;
      for (int64_t begin = 0; begin < nj; begin += CHUNK) {
        const int64_t nodes = nj - begin < CHUNK ? nj - begin : CHUNK, cells = begin + nodes < nj ? nodes : nodes - 1;
        cell_derivatives(i * nj + begin, cells, nj, x, y, f, &energy, &smallest);
        for (int part = 0; part < 8 && cells < nodes; ++part) f[part][nodes] = 0.0;
        for (int c = 0; c < 2; ++c) {
          double *row = gradient + c * ni * nj + i * nj + begin;
          if (i >= first) gather(row, f[c], f[4 + c], nodes, i > 0);
          if (i + 1 < last) gather(row + nj, f[2 + c], f[6 + c], nodes, 0);
        }
        for (int part = 0; part < 8; ++part) f[part][0] = f[part][nodes];
      }
      if (i >= first) row_energy[i] = energy, row_smallest[i] = smallest;
    }
  }
}

/* Along the direction of a vector: the edges' moves (v) and those of their squares and Jacobians (d). */
#define CORNER(A, B, a, b, J, m)                                                                                       \
  const double r##m = 1.0 / J, e##m = (A + B) * r##m, t##m = e##m * r##m;                                              \
  const double dJ##m = v##a##x * b##y + a##x * v##b##y - v##a##y * b##x - a##y * v##b##x;                            \
  const double dr##m = -r##m * r##m * dJ##m;                                                                           \
  const double dt##m = r##m * r##m * (d##A + d##B) - 2.0 * t##m * r##m * dJ##m;

APART void cell_products(int64_t begin, int64_t count, int64_t nj, const double *restrict x, const double *restrict y,
                         const double *restrict u, const double *restrict v, double (*restrict f)[CHUNK + 1]) {
#pragma omp simd
  for (int64_t k = 0; k < count; ++k) {
    const int64_t n = begin + k;
    CELL
    (void)lower;
    const double va0x = u[n + nj] - u[n], va0y = v[n + nj] - v[n], vb0x = u[n + 1] - u[n], vb0y = v[n + 1] - v[n];
    const double va1x = u[n + nj + 1] - u[n + 1], va1y = v[n + nj + 1] - v[n + 1];
    const double vb1x = u[n + nj + 1] - u[n + nj], vb1y = v[n + nj + 1] - v[n + nj];
    const double dA0 = 2.0 * (a0x * va0x + a0y * va0y), dA1 = 2.0 * (a1x * va1x + a1y * va1y);
    const double dB0 = 2.0 * (b0x * vb0x + b0y * vb0y), dB1 = 2.0 * (b1x * vb1x + b1y * vb1y);
    CORNER(A0, B0, a0, b0, J00, 00)
    CORNER(A0, B1, a0, b1, J10, 10)
    CORNER(A1, B0, a1, b0, J01, 01)
    CORNER(A1, B1, a1, b1, J11, 11)
    const double ra0 = 2.0 * (r00 + r10), ra1 = 2.0 * (r01 + r11), rb0 = 2.0 * (r00 + r01), rb1 = 2.0 * (r10 + r11);
    const double sa0 = 2.0 * (dr00 + dr10), sa1 = 2.0 * (dr01 + dr11), sb0 = 2.0 * (dr00 + dr01), sb1 = 2.0 * (dr10 + dr11);
    const double da0x = ra0 * va0x + sa0 * a0x - t00 * vb0y - dt00 * b0y - t10 * vb1y - dt10 * b1y;
    const double da0y = ra0 * va0y + sa0 * a0y + t00 * vb0x + dt00 * b0x + t10 * vb1x + dt10 * b1x;
    const double da1x = ra1 * va1x + sa1 * a1x - t01 * vb0y - dt01 * b0y - t11 * vb1y - dt11 * b1y;
    const double da1y = ra1 * va1y + sa1 * a1y + t01 * vb0x + dt01 * b0x + t11 * vb1x + dt11 * b1x;
    const double db0x = rb0 * vb0x + sb0 * b0x + t00 * va0y + dt00 * a0y + t01 * va1y + dt01 * a1y;
    const double db0y = rb0 * vb0y + sb0 * b0y - t00 * va0x - dt00 * a0x - t01 * va1x - dt01 * a1x;
    const double db1x = rb1 * vb1x + sb1 * b1x + t10 * va0y + dt10 * a0y + t11 * va1y + dt11 * a1y;
    const double db1y = rb1 * vb1y + sb1 * b1y - t10 * va0x - dt10 * a0x - t11 * va1x - dt11 * a1x;
    f[0][k + 1] = -da0x - db0x, f[1][k + 1] = -da0y - db0y, f[2][k + 1] = da0x - db1x, f[3][k + 1] = da0y - db1y;
    f[4][k + 1] = db0x - da1x, f[5][k + 1] = db0y - da1y, f[6][k + 1] = da1x + db1x, f[7][k + 1] = da1y + db1y;
  }
}

EXPORT void winslow_hessian_vector(int64_t ni, int64_t nj, const double *restrict x, const double *restrict y,
                                   const double *restrict vector, double *restrict product, int64_t threads) {
#pragma omp parallel for schedule(static) num_threads((int)threads)
  for (int64_t share = 0; share < threads; ++share) {
    const int64_t first = ni * share / threads, last = ni * (share + 1) / threads;
    for (int64_t i = first > 0 ? first - 1 : 0; i < last && i < ni - 1; ++i) {
      Cells f;
      for (int part = 0; part < 8; ++part) f[part][0] = 0.0;
      for (int64_t begin = 0; begin < nj; begin += CHUNK) {
        const int64_t nodes = nj - begin < CHUNK ? nj - begin : CHUNK, cells = begin + nodes < nj ? nodes : nodes - 1;
        cell_products(i * nj + begin, cells, nj, x, y, vector, vector + ni * nj, f);
        for (int part = 0; part < 8 && cells < nodes; ++part) f[part][nodes] = 0.0;
        for (int c = 0; c < 2; ++c) {
          double *row = product + c * ni * nj + i * nj + begin;
          if (i >= first) gather(row, f[c], f[4 + c], nodes, i > 0);
          if (i + 1 < last) gather(row + nj, f[2 + c], f[6 + c], nodes, 0);
        }
        for (int part = 0; part < 8; ++part) f[part][0] = f[part][nodes];
      }
    }
  }
}
