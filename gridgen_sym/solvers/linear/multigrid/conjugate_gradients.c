/* Conjugate gradients, preconditioned by one V-cycle. */

MULTIPLY_ROW(multiply_row, double)

/* Vectors of an iteration, and one number per row for each of its three sums. */
typedef struct {
  double *x, *r, *p, *q, *norms, *products, *curvatures;
} Vectors;

static Vectors vectors_in(const Level *level, double *work) {
  const int64_t size = vector_size(level), ni = level->ni;
  double *sums = work + 4 * size;
  work += BEFORE * 2 * level->stride;
  return (Vectors){work, work + size, work + 2 * size, work + 3 * size, sums, sums + ni, sums + 2 * ni};
}

/* One step of length alpha for all rows, 0 for the start; returns the norm of r, squared. */
static double step(const Level *level, Team team, Vectors v, double alpha, double scale) {
  const int64_t width = 2 * level->stride;
  ROWS(level, team, i) {
    const int64_t n = i * width;
    v.norms[i] = step_part(alpha, v.p + n, v.q + n, v.x + n, v.r + n, level->right + n, scale, width);
  }
  return total(level, team, v.norms);
}

/* The next direction p from z, the solution of the V-cycle; z.r must be known for beta. */
static double product_with_z(const Level *level, Team team, Vectors v) {
  const int64_t width = 2 * level->stride;
  ROWS(level, team, i) v.products[i] = product_part(level->solution + i * width, v.r + i * width, width);
  return total(level, team, v.products);
}

/* p = z + beta p and q = A p; returns p.q */
static double curvature_along(const Level *level, Team team, Vectors v, double beta) {
  const int64_t S = level->stride, width = 2 * S;
  ROWS(level, team, i) direction_part(beta, level->solution + i * width, v.p + i * width, width);
  wait_for(team);
  ROWS(level, team, i) {
    const double *p = v.p + i * width;
    v.curvatures[i] = multiply_row(level->operator+ i * PLANES * S, p, p, v.q + i * width, 0, S, S);
  }
  return total(level, team, v.curvatures);
}

/* The iteration, run by all threads of a team alike; returns the number of steps, negative as below. */
static int64_t iterate(const Level *levels, int64_t count, Team team, Vectors v, double tolerance, int64_t limit,
                       double *reduction) {
  const int64_t nodes = levels->ni * levels->nj;
  double norm = step(levels, team, v, 0.0, 0.0), previous = 1.0;
  const double first = norm, enough = tolerance * tolerance * first;
  const double scale = first > 0.0 ? 1.0 / sqrt(first / (double)nodes) : 1.0; /* keeps single precision in range */
  wait_for(team);
  norm = step(levels, team, v, 0.0, scale);
  int64_t done = 0;
  while (done < limit && norm > enough) {
    v_cycle(levels, count, team);
    const double product = product_with_z(levels, team, v);
    const double curvature = curvature_along(levels, team, v, done == 0 ? 0.0 : product / previous);
    ++done;
    if (!(curvature > 0.0) || !(product > 0.0)) {
      done = -done;
      break;
    }
    norm = step(levels, team, v, product / curvature, scale);
    previous = product;
  }
  if (team.rank == 0) *reduction = first > 0.0 ? sqrt(norm / first) : 0.0;
  return done;
}

/* Solve A solution = factor right to a relative residual, A being the finest level's; right and solution are planes
 * (2, ni, nj), zero at fixed nodes. work has room for 4 vectors, then for 3 ni numbers. Returns the number of iterations,
 * negative if a direction without positive curvature was met, or a residual along which the V-cycle is not positive (in
 * single precision it need not be, on nearly flat cells): the last direction is then the solution. */
EXPORT int64_t solve(const Level *levels, int64_t count, const double *right, double *solution, double *work,
                     double tolerance, int64_t limit, double factor, double *reduction) {
  const Vectors v = vectors_in(levels, work);
  int64_t iterations = 0;
  WITH_TEAM(team, levels->threads) {
    for (double *vector = v.x; vector <= v.q; vector += v.r - v.x) clear_vector(levels, team, vector);
    wait_for(team);
    take_vector(levels, team, right, v.r);
    wait_for(team);
    const int64_t done = iterate(levels, count, team, v, tolerance, limit, reduction);
    wait_for(team);
    give_vector(levels, team, done < 0 ? v.p : v.x, solution, factor);
    if (team.rank == 0) iterations = done;
  }
  return iterations;
}
