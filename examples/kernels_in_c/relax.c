/* Relax a distorted grid of a square with the kernels of the functional `smooth`. */
#include <math.h>
#include <stdio.h>

#include "smooth.h"

enum { N = 17 };

static double xy[2][N][N]; /* x and y of the nodes */
static const double parameters[] = {0.5}; /* k */
static const GridgenBlock block = {.ni = N, .nj = N, .row_begin = 0, .row_end = N, .stride = N, .plane = N * N,
                                   .threads = 1, .h_xi = 1.0, .h_eta = 1.0};

/* Print the energy of the grid, and its smallest Jacobian. */
static void report(const char *when) {
  double row_energy[N - 1], row_min_jacobian[N - 1], energy = 0.0, smallest = INFINITY;
  smooth_energy(&block, &xy[0][0][0], NULL, parameters, row_energy, row_min_jacobian);
  for (int i = 0; i < N - 1; ++i) {
    energy += row_energy[i];
    smallest = fmin(smallest, row_min_jacobian[i]);
  }
  printf("%s: energy %.2f, smallest Jacobian %.3f\n", when, energy, smallest);
}

int main(void) {
  static const uint8_t fixed[N][N]; /* The nodes at the boundary never move; none of the others is fixed. */
  double row_step[N] = {0.0};
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      const double bump = sin(3.14159265 * i / (N - 1)) * sin(3.14159265 * j / (N - 1));
      xy[0][i][j] = i + 3.0 * bump;
      xy[1][i][j] = j - 2.0 * bump;
    }
  report("distorted");
  for (int sweep = 0; sweep < 300; ++sweep)
    for (int color = 0; color < 4; ++color)
      smooth_sweep(&block, &xy[0][0][0], NULL, parameters, &fixed[0][0], color, 0.0, INFINITY, row_step);
  report("relaxed");
  return 0;
}
