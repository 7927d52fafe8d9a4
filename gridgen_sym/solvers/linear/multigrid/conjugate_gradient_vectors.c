/* The three passes over vectors of an iteration of conjugate gradients, over a part of them. */

/* x += alpha p, r -= alpha q, and the right-hand side of the V-cycle from r; returns r.r */
APART double step_part(double alpha, const double *restrict p, const double *restrict q, double *restrict x,
                       double *restrict r, float *restrict right, double scale, int64_t count) {
  double norm = 0.0;
#pragma omp simd reduction(+ : norm)
  for (int64_t n = 0; n < count; ++n) {
    x[n] += alpha * p[n];
    const double rest = r[n] - alpha * q[n];
    r[n] = rest, right[n] = (float)(scale * rest);
    norm += rest * rest;
  }
  return norm;
}

/* z.r */
APART double product_part(const float *restrict z, const double *restrict r, int64_t count) {
  double product = 0.0;
#pragma omp simd reduction(+ : product)
  for (int64_t n = 0; n < count; ++n) product += z[n] * r[n];
  return product;
}

/* p = z + beta p */
APART void direction_part(double beta, const float *restrict z, double *restrict p, int64_t count) {
#pragma omp simd
  for (int64_t n = 0; n < count; ++n) p[n] = z[n] + beta * p[n];
}
