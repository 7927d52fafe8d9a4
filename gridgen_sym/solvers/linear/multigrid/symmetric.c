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
APART void coarsen_row(const float *restrict a, float *restrict c, int64_t nj, int64_t S, int above, int below) {
  /* Weights instead of conditions: of the row itself, the row above and the row below. */
  const float half_above = above ? 0.5f : 0.0f, half_below = below ? 0.5f : 0.0f, own = above ? 0.5f : 1.0f;
  const float quarter_above = 0.5f * half_above, quarter_below = 0.5f * half_below;
  const float *restrict next = a + PLANES * S, *restrict previous = a - PLANES * S;
  for (int e = 0; e < 3; ++e) {
    const int xy = e == 0 ? 0 : e == 1 ? 1 : 3, yx = transposed[xy];
    const int64_t at = e * S, n = (3 + xy) * S, m = (3 + yx) * S;
    for (int64_t j = 0; j < nj; ++j)
      c[at + j] = a[at + j] + half_above * (a[n + j] + a[m + j]) + quarter_above * next[at + j] +
                  half_below * (previous[n + j] + previous[m + j]) + quarter_below * previous[at + j];
  }
  for (int e = 0; e < 4; ++e) {
    const int64_t self = stored[e] * S, up = (3 + e) * S, along = (7 + e) * S, right = (11 + e) * S, left = (15 + e) * S;
    const int64_t along_t = (7 + transposed[e]) * S, left_t = (15 + transposed[e]) * S;
    for (int64_t j = 0; j < nj; ++j) {
      c[along + j] = a[along + j] + half_above * (a[right + j] + a[left_t + j + 1]) + quarter_above * next[along + j] +
                     half_below * (previous[right + j] + previous[left_t + j + 1]) + quarter_below * previous[along + j];
      c[up + j] = own * a[up + j] + half_above * next[up + j] + quarter_above * next[self + j];
      c[right + j] = own * a[right + j] + half_above * next[right + j] + quarter_above * next[along + j];
      c[left + j] = own * a[left + j] + half_above * next[left + j] + quarter_above * next[along_t + j - 1];
    }
  }
}

/* The same along j for one coarse node: `a` and `c` point to the fine and the coarse node, S and C numbers from entry to
 * entry. */
INLINE void coarsen_node(const float *restrict a, float *restrict c, int64_t S, int64_t C, int above, int below) {
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
