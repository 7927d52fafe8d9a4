/* The levels of a multigrid hierarchy, and how the threads of a team share them.
 *
 * Nothing here knows a functional: a stencil comes from a generated kernel, as planes in double precision. It is kept in
 * single precision, which is half of the memory to read; Newton's method needs no better. Rows of nodes are `stride`
 * numbers apart and stand together for all entries and components: row i of an operator is PLANES rows of numbers, that
 * of a vector two, x and y. Nodes on the edge are fixed, and couplings with fixed nodes are zero.
 */
#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#if defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#define APART static __attribute__((noinline)) /* a loop that is inlined into another loses `restrict` */
#else
#define INLINE static inline
#define APART static
#endif

typedef struct {
  int64_t ni, nj, stride, threads;
  float *operator;            /* PLANES per row */
  float *pivots_i, *pivots_j; /* PIVOTS per row: inverse pivots of the lines along i and along j */
  float *right, *solution, *work; /* vectors */
  const uint8_t *fixed;       /* (ni, nj) */
} Level;

/* The threads that work on a level together; each of them calls the same functions with its own rank. */
typedef struct {
  int64_t rank, size;
} Team;

#define PRAGMA(text) _Pragma(#text)
#ifdef _OPENMP
#define WITH_TEAM(team, threads)                                   \
  PRAGMA(omp parallel num_threads((int)(threads)) if ((threads) > 1)) \
  for (Team team = {omp_get_thread_num(), omp_get_num_threads()}, *once = &team; once; once = 0)
#else
#define WITH_TEAM(team, threads) for (Team team = {0, 1}, *once = &team; once; once = 0)
#endif

INLINE void wait_for(Team team) {
  if (team.size > 1) {
#pragma omp barrier
  }
}

/* Where the part of a thread begins among `count` things; that of the next rank is where it ends. */
INLINE int64_t share(int64_t count, int64_t rank, int64_t size) { return count * rank / size; }

/* Inner rows of a level that belong to a thread, i from `begin` up to `end`. */
#define ROWS(level, team, i)                                                                                 \
  for (int64_t i = 1 + share((level)->ni - 2, (team).rank, (team).size),                                     \
               i##_end = 1 + share((level)->ni - 2, (team).rank + 1, (team).size);                           \
       i < i##_end; ++i)
