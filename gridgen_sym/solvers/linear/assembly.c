/* Compressed columns of the matrix of a stencil of nine nodes, by arithmetic: columns and rows come in their order.
 *
 * Nothing here knows a functional: entries come from a generated kernel, as planes. `Index` is the type of row numbers, and
 * is defined before this file.
 *
 * `numbers` are those of the free nodes, -1 at the others, with a margin of -1 of one node around the grid. Neighbors are
 * counted in the order of the array: (i-1, j-1), (i-1, j), ..., (i+1, j+1).
 */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* Where the neighbors of a node are in an array with rows of `width`. */
static void find_shifts(int64_t width, int64_t shifts[9]) {
  for (int64_t neighbor = 0; neighbor < 9; neighbor++)
    shifts[neighbor] = (neighbor / 3 - 1) * width + neighbor % 3 - 1;
}

/* Write where the columns of each unknown end, after a zero. */
EXPORT void count_entries(int64_t ni, int64_t nj, const Index *numbers, Index *ends) {
  int64_t shifts[9];
  find_shifts(nj + 2, shifts);
  Index total = 0;
  *ends++ = 0;
  for (int64_t i = 0; i < ni; i++)
    for (int64_t j = 0; j < nj; j++) {
      const Index *here = numbers + (i + 1) * (nj + 2) + j + 1;
      if (*here < 0)
        continue;
      Index count = 0;
      for (int64_t neighbor = 0; neighbor < 9; neighbor++)
        count += here[shifts[neighbor]] >= 0;
      *ends++ = total += 2 * count;
      *ends++ = total += 2 * count;
    }
}

/* Write the rows and the values of all columns; `sources` says where the value of an entry is in the planes, relative to the
 * node of its column: by neighbor, component of the column, component of the row. */
EXPORT void fill_entries(int64_t ni, int64_t nj, int64_t threads, const Index *numbers, const Index *starts,
                         const double *planes, const int64_t *sources, Index *rows, double *values) {
  int64_t shifts[9];
  find_shifts(nj + 2, shifts);
  (void)threads;
#ifdef _OPENMP
#pragma omp parallel for num_threads((int)threads) if (threads > 1) schedule(static)
#endif
  for (int64_t i = 0; i < ni; i++)
    for (int64_t j = 0; j < nj; j++) {
      const Index *here = numbers + (i + 1) * (nj + 2) + j + 1;
      if (*here < 0)
        continue;
      const double *node = planes + i * nj + j;
      Index at = starts[2 * *here];
      for (int64_t column = 0; column < 2; column++)
        for (int64_t neighbor = 0; neighbor < 9; neighbor++) {
          const Index number = here[shifts[neighbor]];
          if (number < 0)
            continue;
          const int64_t *source = sources + 4 * neighbor + 2 * column;
          rows[at] = 2 * number, rows[at + 1] = 2 * number + 1;
          values[at] = node[source[0]], values[at + 1] = node[source[1]];
          at += 2;
        }
    }
}
