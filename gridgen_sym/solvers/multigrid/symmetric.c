/* The symmetric stencil of a Hessian, of which 19 planes are stored: the block of node (i, j) with itself (xx, xy, yy),
 * then those with (i+1, j), (i, j+1), (i+1, j+1), (i+1, j-1) (xx, xy, yx, yy each).
 */
enum { PLANES = 19, PIVOTS = 3 };
#define SYMMETRIC 1
static const int transposed[4] = {0, 2, 1, 3}; /* entry of a block stored as xx, xy, yx, yy */
static const int stored[4] = {0, 1, 1, 2};     /* entry of a symmetric block stored as xx, xy, yy */

/* Entries of the row `a` of an operator, S and R numbers from entry to entry and from row to row, at column j: the block
 * of a node with itself, and with the next and the previous node of its line. */
#define OWN(a, e) (a)[stored[e] * S + j]
#define PIVOT(p, e) (p)[stored[e] * S + j]
#define NEXT_I(a, e) (a)[(3 + (e)) * S + j]
#define NEXT_J(a, e) (a)[(7 + (e)) * S + j]
#define PREVIOUS_I(a, e) (a)[(3 + transposed[e]) * S - R + j]
#define PREVIOUS_J(a, e) (a)[(7 + transposed[e]) * S + j - 1]

/* Add to (sx, sy) the couplings with the node at (di, dj) and with that opposite; the former are block k. */
#define COUPLE(k, di, dj)                                                                                     \
  {                                                                                                           \
    const int64_t to = (di) * 2 * S + (dj) + j;                                                               \
    const int64_t from = -(di) * 2 * S - (dj) + j, back = -(di) * R - (dj) + j;                               \
    sx += a[(3 + 4 * k) * S + j] * x[to] + a[(4 + 4 * k) * S + j] * x[S + to] +                               \
          a[(3 + 4 * k) * S + back] * x[from] + a[(5 + 4 * k) * S + back] * x[S + from];                      \
    sy += a[(5 + 4 * k) * S + j] * x[to] + a[(6 + 4 * k) * S + j] * x[S + to] +                               \
          a[(4 + 4 * k) * S + back] * x[from] + a[(6 + 4 * k) * S + back] * x[S + from];                      \
  }

/* The neighbor to which an entry couples. */
INLINE void neighbor_of(int plane, int64_t *di, int64_t *dj) {
  static const int shifts[5][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {1, -1}};
  const int block = plane < 3 ? 0 : (plane + 1) / 4;
  *di = shifts[block][0], *dj = shifts[block][1];
}

/* Galerkin coarsening along i of one row: coarse row I sits on a fine row; a fine row between two coarse ones is the
 * mean of them. A_II = S_p + (N_p + N_p')/2 + (N_o + N_o')/2 + (S_o + S_o+)/4 and A_I,I+1 = (N_p + N_o)/2 + S_o/4,
 * where S is a row's coupling with itself, N that with the next row, o the row between.
 * above, below: whether there is a row between this one and the next, and the previous one. */
APART void coarsen_along_i(const float *restrict a, float *restrict c, int64_t nj, int64_t S, int above, int below) {
  const int64_t R = PLANES * S;
  for (int e = 0; e < 3; ++e) {
    const int xy = e == 0 ? 0 : e == 1 ? 1 : 3, yx = transposed[xy];
    for (int64_t j = 0; j < nj; ++j) {
      float sum = a[e * S + j];
      if (above) sum += 0.5f * (a[(3 + xy) * S + j] + a[(3 + yx) * S + j]) + 0.25f * a[e * S + R + j];
      if (below) sum += 0.5f * (a[(3 + xy) * S - R + j] + a[(3 + yx) * S - R + j]) + 0.25f * a[e * S - R + j];
      c[e * S + j] = sum;
    }
  }
  for (int e = 0; e < 4; ++e) {
    const int t = transposed[e], s = stored[e];
    for (int64_t j = 0; j < nj; ++j) {
      const int64_t left = j > 0 ? j - 1 : 0, right = j < nj - 1 ? j + 1 : j;
      const float inside = j < nj - 1 ? 1.0f : 0.0f, inside_left = j > 0 ? 1.0f : 0.0f;
      float along = a[(7 + e) * S + j];
      if (above)
        along += inside * 0.5f * (a[(11 + e) * S + j] + a[(15 + t) * S + right]) + 0.25f * a[(7 + e) * S + R + j];
      if (below)
        along +=
            inside * 0.5f * (a[(11 + e) * S - R + j] + a[(15 + t) * S - R + right]) + 0.25f * a[(7 + e) * S - R + j];
      c[(7 + e) * S + j] = along;
      float up = a[(3 + e) * S + j], up_right = a[(11 + e) * S + j], up_left = a[(15 + e) * S + j];
      if (above) {
        up = 0.5f * (up + a[(3 + e) * S + R + j]) + 0.25f * a[s * S + R + j];
        up_right = 0.5f * (up_right + a[(11 + e) * S + R + j]) + 0.25f * a[(7 + e) * S + R + j];
        up_left = 0.5f * (up_left + a[(15 + e) * S + R + j]) + 0.25f * inside_left * a[(7 + t) * S + R + left];
      }
      c[(3 + e) * S + j] = up, c[(11 + e) * S + j] = up_right, c[(15 + e) * S + j] = up_left;
    }
  }
}

/* The same along j for one coarse node: `a` and `c` point to the fine and the coarse node, S and C numbers from entry to
 * entry. */
INLINE void coarsen_along_j(const float *restrict a, float *restrict c, int64_t S, int64_t C, int above, int below) {
  for (int e = 0; e < 3; ++e) {
    const int xy = e == 0 ? 0 : e == 1 ? 1 : 3, yx = transposed[xy];
    float sum = a[e * S];
    if (above) sum += 0.5f * (a[(7 + xy) * S] + a[(7 + yx) * S]) + 0.25f * a[e * S + 1];
    if (below) sum += 0.5f * (a[(7 + xy) * S - 1] + a[(7 + yx) * S - 1]) + 0.25f * a[e * S - 1];
    c[e * C] = sum;
  }
  for (int e = 0; e < 4; ++e) {
    const int s = stored[e];
    /* From (i, q) to (i+1, q), collected over the columns that belong to this coarse one. */
    float up = a[(3 + e) * S];
    if (above) up += 0.5f * (a[(11 + e) * S] + a[(15 + e) * S + 1]) + 0.25f * a[(3 + e) * S + 1];
    if (below) up += 0.5f * (a[(11 + e) * S - 1] + a[(15 + e) * S]) + 0.25f * a[(3 + e) * S - 1];
    c[(3 + e) * C] = up;
    /* To the next column: (0, 1) and (1, 1); (1, -1) goes to the column before. */
    float along = a[(7 + e) * S], up_right = a[(11 + e) * S], up_left = a[(15 + e) * S];
    if (above) {
      along = 0.5f * (along + a[(7 + e) * S + 1]) + 0.25f * a[s * S + 1];
      up_right = 0.5f * (up_right + a[(11 + e) * S + 1]) + 0.25f * a[(3 + e) * S + 1];
    }
    if (below) up_left = 0.5f * (up_left + a[(15 + e) * S - 1]) + 0.25f * a[(3 + e) * S - 1];
    c[(7 + e) * C] = along, c[(11 + e) * C] = up_right, c[(15 + e) * C] = up_left;
  }
}
