/* What Krylov's methods share: vectors in double precision. */

/* How many numbers a vector has with its margin: the rows before it, two so that a column before the first of them exists,
 * and the row after it. */
enum { BEFORE = 2 };
static int64_t vector_size(const Level *level) { return 2 * (level->ni + BEFORE + 1) * level->stride; }

/* Zero everywhere, and so for good in the margin and at fixed nodes. */
static void clear_vector(const Level *level, Team team, double *vector) {
  const int64_t width = 2 * level->stride, rows = level->ni + BEFORE + 1;
  double *first = vector - BEFORE * width;
  for (int64_t i = share(rows, team.rank, team.size); i < share(rows, team.rank + 1, team.size); ++i)
    memset(first + i * width, 0, (size_t)width * sizeof(double));
}

/* The sum of what all threads have put into `row`, one number for each row: the same for any number of threads. */
static double total(const Level *level, Team team, const double *row) {
  wait_for(team);
  double sum = 0.0;
  for (int64_t i = level->begin_i; i < level->end_i; ++i) sum += row[i];
  return sum;
}
