/* The levels of a multigrid hierarchy, and how the threads of a team share them.
 *
 * Nothing here knows a functional: a stencil comes from a generated kernel, as planes in double precision. It is kept in
 * single precision, which is half of the memory to read; Newton's method needs no better. Rows of nodes are `stride`
 * numbers apart and stand together for all entries and components: row i of an operator is PLANES rows of numbers, that
 * of a vector two, x and y. Couplings with fixed nodes are zero. Around the grid is a margin of zeros, of a row and a column
 * on each side: rows are longer than the grid, so that the column before the first is the end of the row before.
 */
#define _POSIX_C_SOURCE 200112L /* sched_yield */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wpass-failed" /* a loop that is not vectorized is slower, and not wrong */
#endif
#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#if defined(_OPENMP) && defined(__GNUC__) && !defined(_WIN32)
#include <sched.h>
#define YIELDS 1
#else
#define YIELDS 0
#endif

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
/* What one of the two stencils needs, and the other one does not. */
#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
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
  const uint8_t *fixed;       /* at node (0, 0), in rows of nj + 2: fixed nodes, and the margin, are 1 */
  int64_t begin_i, end_i, begin_j, end_j; /* the rows and columns with nodes that are not fixed */
  const int64_t *kept_i, *kept_j; /* the rows and columns of the finer level that this one has; if 0, every second one and
                                     the last, or all where there are as many */
} Level;

/* The mask of a row. */
INLINE const uint8_t *fixed_row(const Level *level, int64_t i) { return level->fixed + i * (level->nj + 2); }

/* Where threads wait for each other: how many have come, and how often all have. */
typedef struct {
  int64_t arrived, phase;
} Meeting;

/* The threads that work on a level together; each of them calls the same functions with its own rank. */
typedef struct {
  int64_t rank, size;
  Meeting *meeting;
} Team;

#define PRAGMA(text) _Pragma(#text)
#ifdef _OPENMP
#define WITH_TEAM(team, threads)                                                                             \
  Meeting meeting = {0, 0};                                                                                  \
  PRAGMA(omp parallel num_threads((int)(threads)) if ((threads) > 1))                                        \
  for (Team team = {omp_get_thread_num(), omp_get_num_threads(), &meeting}, *once = &team; once; once = 0)
#else
#define WITH_TEAM(team, threads) for (Team team = {0, 1, 0}, *once = &team; once; once = 0)
#endif

/* Wait for all threads of a team. OpenMP's barrier spins for milliseconds: where another process has the processor of one
 * thread, all the others would burn theirs. */
INLINE void wait_for(Team team) {
  if (team.size == 1) return;
#if YIELDS
  Meeting *meeting = team.meeting;
  const int64_t phase = __atomic_load_n(&meeting->phase, __ATOMIC_ACQUIRE);
  if (__atomic_add_fetch(&meeting->arrived, 1, __ATOMIC_ACQ_REL) == team.size) {
    __atomic_store_n(&meeting->arrived, 0, __ATOMIC_RELAXED);
    __atomic_store_n(&meeting->phase, phase + 1, __ATOMIC_RELEASE);
    return;
  }
  for (int spins = 0; __atomic_load_n(&meeting->phase, __ATOMIC_ACQUIRE) == phase; ++spins)
    if (spins > 20000) sched_yield();
#else
#pragma omp barrier
#endif
}

/* Where the part of a thread begins among `count` things; that of the next rank is where it ends. */
INLINE int64_t share(int64_t count, int64_t rank, int64_t size) { return count * rank / size; }

/* Rows of a level, of those with unknowns, that belong to a thread. */
#define ROWS(level, team, i)                                                                                 \
  for (int64_t i##_count = (level)->end_i - (level)->begin_i,                                                \
               i = (level)->begin_i + share(i##_count, (team).rank, (team).size),                            \
               i##_end = (level)->begin_i + share(i##_count, (team).rank + 1, (team).size);                  \
       i < i##_end; ++i)
