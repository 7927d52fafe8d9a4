/* The levels of several blocks: their setup, and a cycle over them. */

/* One level of all blocks. */
typedef struct {
  int64_t blocks, threads, size; /* size: the numbers of a vector of all blocks, with the margins */
  Level *levels, *relaxed;       /* with all rows that have unknowns; with the inner ones, whose lines are relaxed */
  Shared *shared;
  Crossing *crossing;
  float *solution; /* of all blocks */
} BlockLevel;

/* Find the rows and columns with unknowns. */
EXPORT void find_rows(const BlockLevel *level) {
  for (Level *block = level->levels; block < level->levels + level->blocks; ++block) {
    const int64_t ni = block->ni, nj = block->nj;
    int first_j = 0, last_j = 0;
    for (int64_t i = 0; i < ni; ++i) first_j |= !fixed_row(block, i)[0], last_j |= !fixed_row(block, i)[nj - 1];
    block->begin_i = memchr(fixed_row(block, 0), 0, (size_t)nj) == 0;
    block->end_i = ni - (memchr(fixed_row(block, ni - 1), 0, (size_t)nj) == 0);
    block->begin_j = !first_j, block->end_j = nj - !last_j;
  }
}

/* Take the finest operators: the planes of each block, times a factor. */
EXPORT void take_blocks(const BlockLevel *level, const double *const *planes, double factor) {
  EACH_BLOCK(level->blocks, level->threads, take_rows(level->levels + b, team, planes[b], factor);)
}

/* Set Galerkin's operators; interpolation on a side needs the nodes of that side only. `rows` has `width` numbers for each
 * thread, and is zero. */
EXPORT void coarsen_blocks(const BlockLevel *fine, const BlockLevel *coarse, float *rows, int64_t width) {
  EACH_BLOCK(fine->blocks, fine->threads, {
    /* What an earlier block has left beyond the end of this one's rows would count. */
    float *row = rows + own * width;
    const int64_t S = fine->levels[b].stride;
    for (int plane = 0; plane < PLANES; ++plane)
      for (int64_t j = fine->levels[b].nj; j < S; ++j) row[plane * S + j] = 0.0f;
    coarsen_rows(fine->levels + b, coarse->levels + b, team, row);
  })
}

/* Eliminate along lines, invert the blocks of shared nodes, and find those on crossing lines. Returns how many nodes cannot
 * be solved for, or -1 if there is not enough room for the lines. */
EXPORT int64_t factor_blocks(const BlockLevel *level) {
  int64_t unusable = 0;
  EACH_BLOCK(level->blocks, level->threads, {
    const int64_t found = factor_all(level->relaxed + b, team);
    PRAGMA(omp atomic)
    unusable += found;
  })
  unusable += factor_shared(level->levels, level->shared);
  return unusable ? unusable : find_crossing(level->levels, level->blocks, level->shared, level->crossing) < 0 ? -1 : 0;
}

/* The mean size of the couplings along xi and along eta of each block, of some rows. */
EXPORT void coupling_sizes(const BlockLevel *level, int64_t most, double *sizes) {
  static const int planes[2][2] = {{3, 6}, {7, 10}};
  for (int64_t b = 0; b < level->blocks; ++b) {
    const Level *block = level->levels + b;
    const int64_t S = block->stride, step = block->ni > most ? block->ni / most : 1, rows = (block->ni + step - 1) / step;
    for (int axis = 0; axis < 2; ++axis) {
      double sum = 0.0;
      for (int64_t i = 0; i < block->ni; i += step)
        for (int k = 0; k < 2; ++k) {
          const float *row = block->operator+ (i * PLANES + planes[axis][k]) * S;
          for (int64_t j = 0; j < block->nj; ++j) sum += fabs((double)row[j]);
        }
      sizes[2 * b + axis] = sum / (double)(rows * block->nj);
    }
  }
}

/* Correct shared nodes together with the lines that cross there, where there are such. */
static void correct_lines(const BlockLevel *level) {
  if (!level->crossing->count) return;
  EACH_BLOCK(level->blocks, level->threads, if (level->crossing->blocks[b]) compute_residual(level->levels + b, team);)
  correct_crossing(level->levels, level->shared, level->crossing);
}

/* The first half of a V-cycle from zero: down to the right-hand side of the coarsest level. */
EXPORT void cycle_down(const BlockLevel *levels, int64_t count) {
  for (const BlockLevel *level = levels, *coarse = levels + 1; coarse < levels + count; ++level, ++coarse) {
    memset(level->solution, 0, (size_t)level->size * sizeof(float));
    EACH_BLOCK(level->blocks, level->threads, smooth(level->relaxed + b, team, 1);)
    relax_shared(level->levels, level->shared, 0);
    correct_lines(level);
    EACH_BLOCK(level->blocks, level->threads, {
      compute_residual(level->levels + b, team);
      restrict_residual(level->levels + b, coarse->levels + b, team);
    })
  }
}

/* The second half: up from the solution of the coarsest level. */
EXPORT void cycle_up(const BlockLevel *levels, int64_t count) {
  for (const BlockLevel *coarse = levels + count - 1, *level = coarse - 1; level >= levels; --level, --coarse) {
    EACH_BLOCK(level->blocks, level->threads, correct(coarse->levels + b, level->levels + b, team);)
    correct_lines(level);
    relax_shared(level->levels, level->shared, 1);
    EACH_BLOCK(level->blocks, level->threads, smooth_backwards(level->relaxed + b, team);)
  }
}
