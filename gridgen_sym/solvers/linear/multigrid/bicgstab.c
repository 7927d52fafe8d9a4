/* BiCGStab (van der Vorst 1992), preconditioned by one V-cycle. */

MULTIPLY_ROW(multiply_row, float)
MULTIPLY_ROW(multiply_double_row, double)

typedef struct {
  double *x, *r, *shadow, *p, *v, *t, *first, *second;
} Vectors;

static Vectors vectors_in(const Level *level, double *work) {
  const int64_t size = vector_size(level);
  double *sums = work + 6 * size;
  work += BEFORE * 2 * level->stride;
  return (Vectors){work,            work + size,     work + 2 * size, work + 3 * size,
                   work + 4 * size, work + 5 * size, sums,            sums + level->ni};
}

/* Inner product of two vectors; `row` must not be that of the product before. */
static double inner(const Level *level, Team team, const double *a, const double *b, double *row) {
  const int64_t width = 2 * level->stride;
  ROWS(level, team, i) {
    double product = 0.0;
#pragma omp simd reduction(+ : product)
    for (int64_t n = i * width; n < (i + 1) * width; ++n) product += a[n] * b[n];
    row[i] = product;
  }
  return total(level, team, row);
}

/* result = A z with z = V-cycle(vector), which is kept in the finest level; returns the product of `with` and the result. */
static double apply(const Level *levels, int64_t count, Team team, const double *vector, double scale, const double *with,
                    double *result, double *row) {
  const int64_t S = levels->stride, width = 2 * S;
  ROWS(levels, team, i)
    for (int64_t n = i * width; n < (i + 1) * width; ++n) levels->right[n] = (float)(scale * vector[n]);
  wait_for(team);
  v_cycle(levels, count, team);
  ROWS(levels, team, i)
    row[i] = multiply_row(levels->operator+ i * PLANES * S, levels->solution + i * width, with + i * width,
                          result + i * width, levels->begin_j, levels->end_j, S);
  return total(levels, team, row);
}

/* x += length z, r -= length image; returns r.r */
static double step(const Level *level, Team team, Vectors w, double length, const double *image, double *row) {
  const int64_t width = 2 * level->stride;
  ROWS(level, team, i) {
    double norm = 0.0;
#pragma omp simd reduction(+ : norm)
    for (int64_t n = i * width; n < (i + 1) * width; ++n) {
      w.x[n] += length * level->solution[n];
      w.r[n] -= length * image[n];
      norm += w.r[n] * w.r[n];
    }
    row[i] = norm;
  }
  return total(level, team, row);
}

/* r = shadow = r - A x with the solution so far, whose residual has drifted from the r of the recursion; returns r.r */
static double restart(const Level *level, Team team, Vectors w, const double *right) {
  const int64_t S = level->stride, width = 2 * S;
  wait_for(team); /* another thread may still be summing the norms of the last step */
  take_vector(level, team, right, w.r);
  ROWS(level, team, i) {
    const int64_t n = i * width;
    multiply_double_row(level->operator+ i * PLANES * S, w.x + n, w.r + n, w.t + n, level->begin_j,
                        level->end_j, S);
    for (int64_t k = n; k < n + width; ++k) w.r[k] -= w.t[k], w.shadow[k] = w.r[k];
  }
  return inner(level, team, w.r, w.r, w.first);
}

/* The iteration, run by all threads of a team alike, until r.r is `enough`; returns the number of products with A. */
static int64_t iterate(const Level *levels, int64_t count, Team team, Vectors w, double norm, double enough,
                       double scale, int64_t limit) {
  const int64_t width = 2 * levels->stride;
  double rho = 1.0, alpha = 1.0, omega = 1.0;
  int64_t done = 0;
  while (done < limit && norm > enough) {
    const double next = inner(levels, team, w.shadow, w.r, w.second), beta = done ? next / rho * (alpha / omega) : 0.0;
    rho = next;
    ROWS(levels, team, i)
      for (int64_t n = i * width; n < (i + 1) * width; ++n)
        w.p[n] = done ? w.r[n] + beta * (w.p[n] - omega * w.v[n]) : w.r[n];
    alpha = rho / apply(levels, count, team, w.p, scale, w.shadow, w.v, w.first);
    norm = step(levels, team, w, alpha, w.v, w.second);
    done += 1;
    if (!(norm > enough)) break;
    const double along = apply(levels, count, team, w.r, scale, w.r, w.t, w.first);
    omega = along / inner(levels, team, w.t, w.t, w.second);
    norm = step(levels, team, w, omega, w.t, w.first);
    done += 1;
  }
  return done;
}

/* Iterate and restart until the true residual is small enough; returns the number of products with A. */
static int64_t iterate_and_restart(const Level *levels, int64_t count, Team team, Vectors w, const double *right,
                                   double tolerance, int64_t limit, double *reduction) {
  const double nodes = (double)(levels->ni * levels->nj), first = restart(levels, team, w, right);
  const double enough = tolerance * tolerance * first;
  double norm = first;
  int64_t done = 0;
  while (done < limit && norm > enough) {
    const double scale = 1.0 / sqrt(norm / nodes); /* keeps single precision in range */
    done += 1 + iterate(levels, count, team, w, norm, enough, scale, limit - done);
    norm = restart(levels, team, w, right);
  }
  if (team.rank == 0) *reduction = first > 0.0 ? sqrt(norm / first) : 0.0;
  return done;
}

/* Solve A solution = factor right to a relative residual, A being the finest level's; right and solution are planes
 * (2, ni, nj), zero at fixed nodes. work has room for 6 vectors, then for 2 ni numbers. Returns the number of products. */
EXPORT int64_t solve(const Level *levels, int64_t count, const double *right, double *solution, double *work,
                     double tolerance, int64_t limit, double factor, double *reduction) {
  const Vectors w = vectors_in(levels, work);
  int64_t iterations = 0;
  WITH_TEAM(team, levels->threads) {
    for (double *vector = w.x; vector <= w.t; vector += w.r - w.x) clear_vector(levels, team, vector);
    wait_for(team);
    const int64_t done = iterate_and_restart(levels, count, team, w, right, tolerance, limit, reduction);
    wait_for(team);
    give_vector(levels, team, w.x, solution, factor);
    if (team.rank == 0) iterations = done;
  }
  return iterations;
}
