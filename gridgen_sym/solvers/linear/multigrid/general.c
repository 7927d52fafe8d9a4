/* The stencil of the Euler-Lagrange equations, not symmetric, of 36 planes: nine blocks in the order (i-1, j-1),
 * (i-1, j), ..., (i+1, j+1) (xx, xy, yx, yy each).
 */
enum { PLANES = 36, PIVOTS = 4 };
#define SYMMETRIC 0

/* Entries of the row `a` of an operator, S numbers from entry to entry, at column j: the block of a node with itself, and
 * with the next and the previous node of its line. */
#define OWN(a, e) (a)[(16 + (e)) * S + j]
#define PIVOT(p, e) (p)[(e) * S + j]
#define NEXT_I(a, e) (a)[(28 + (e)) * S + j]
#define NEXT_J(a, e) (a)[(20 + (e)) * S + j]
#define PREVIOUS_I(a, e) (a)[(4 + (e)) * S + j]
#define PREVIOUS_J(a, e) (a)[(12 + (e)) * S + j]

/* Add to (sx, sy) the couplings with the node at (di, dj) and with that opposite; k is not used. */
#define COUPLE(k, di, dj) COUPLE_ONE(di, dj) COUPLE_ONE(-(di), -(dj))
#define COUPLE_ONE(di, dj)                                                                       \
  {                                                                                              \
    const int64_t to = (di) * 2 * S + (dj) + j, block = 4 * (3 * (di) + (dj) + 4) * S + j;       \
    sx += a[block] * x[to] + a[S + block] * x[S + to];                                           \
    sy += a[2 * S + block] * x[to] + a[3 * S + block] * x[S + to];                               \
  }

/* The neighbor to which an entry couples. */
INLINE void neighbor_of(int plane, int64_t *di, int64_t *dj) { *di = plane / 12 - 1, *dj = plane / 4 % 3 - 1; }

/* Galerkin coarsening along i of one row: coarse row I sits on a fine row p, and a fine row between two coarse ones is
 * the mean of them. With M, U, D a row's couplings with itself, the next and the previous one, o the row between,
 * A_II = M_p + (U_p + D_o)/2 + M_o/4 + the same below, A_I,I+1 = (U_p + U_o)/2 + M_o/4, A_I,I-1 = (D_p + D_o)/2 + M_o/4.
 * above, below: whether there is a row between this one and the next, and the previous one. */
APART void coarsen_row(const float *restrict a, float *restrict c, int64_t nj, int64_t S, int above, int below) {
  const int64_t R = PLANES * S;
  for (int part = 0; part < 12; ++part) {
    const float *down = a + part * S, *middle = down + 12 * S, *up = down + 24 * S;
    float *to = c + part * S;
    for (int64_t j = 0; j < nj; ++j) {
      float self = middle[j], forth = up[j], back = down[j];
      if (above) {
        self += 0.5f * (up[j] + down[R + j]) + 0.25f * middle[R + j];
        forth = 0.5f * (forth + up[R + j]) + 0.25f * middle[R + j];
      }
      if (below) {
        self += 0.5f * (down[j] + up[j - R]) + 0.25f * middle[j - R];
        back = 0.5f * (back + down[j - R]) + 0.25f * middle[j - R];
      }
      to[j] = back, to[12 * S + j] = self, to[24 * S + j] = forth;
    }
  }
}

/* The same along j for one coarse node: `a` and `c` point to the fine and the coarse node, S and C numbers from entry to
 * entry. */
INLINE void coarsen_node(const float *restrict a, float *restrict c, int64_t S, int64_t C, int above, int below) {
  for (int row = 0; row < 3; ++row)
    for (int e = 0; e < 4; ++e) {
      const float *left = a + (12 * row + e) * S, *middle = left + 4 * S, *right = left + 8 * S;
      float *to = c + (12 * row + e) * C, self = middle[0], forth = right[0], back = left[0];
      if (above) {
        self += 0.5f * (right[0] + left[1]) + 0.25f * middle[1];
        forth = 0.5f * (forth + right[1]) + 0.25f * middle[1];
      }
      if (below) {
        self += 0.5f * (left[0] + right[-1]) + 0.25f * middle[-1];
        back = 0.5f * (back + left[-1]) + 0.25f * middle[-1];
      }
      to[0] = back, to[4 * C] = self, to[8 * C] = forth;
    }
}
