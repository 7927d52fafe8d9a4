/* A kernel on many blocks: one call from Python for all of them. */
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* The kernels are compiled apart; what they take is said in their headers, by the number of arrays that they write. */
typedef struct GridgenBlock GridgenBlock;
typedef void (*Kernel)(void);
typedef void (*WritesOne)(const GridgenBlock *, const double *, const double *const *, const double *, double *);
typedef void (*WritesTwo)(const GridgenBlock *, const double *, const double *const *, const double *, double *, double *);
typedef void (*WritesThree)(const GridgenBlock *, const double *, const double *const *, const double *, double *, double *,
                            double *);

/* Run a kernel on `count` blocks, which are `size` bytes each. Coordinates, values and `results` have a row for each block;
 * `results` has `arrays` pointers in it. More than one thread shares the blocks. */
EXPORT void run_on_blocks(Kernel kernel, int64_t arrays, int64_t count, int64_t threads, const char *blocks, int64_t size,
                          const double *const *coordinates, const double *const *const *values, const double *parameters,
                          double *const *results) {
  (void)threads; /* not used where there is no OpenMP */
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic) num_threads((int)threads) if (threads > 1)
#endif
  for (int64_t b = 0; b < count; ++b) {
    const GridgenBlock *block = (const GridgenBlock *)(const void *)(blocks + b * size);
    double *const *to = results + arrays * b;
    if (arrays == 1)
      ((WritesOne)kernel)(block, coordinates[b], values[b], parameters, to[0]);
    else if (arrays == 2)
      ((WritesTwo)kernel)(block, coordinates[b], values[b], parameters, to[0], to[1]);
    else
      ((WritesThree)kernel)(block, coordinates[b], values[b], parameters, to[0], to[1], to[2]);
  }
}
