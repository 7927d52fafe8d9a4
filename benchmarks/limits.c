/* What this machine can do at most: memory bandwidth (STREAM's triad), multiply-adds and divisions. */
#include <stdint.h>

#define EXPORT __attribute__((visibility("default")))
#if defined(__AVX512F__)
enum { LANES = 8 };
#elif defined(__AVX__)
enum { LANES = 4 };
#else
enum { LANES = 2 };
#endif
typedef double vector __attribute__((vector_size(8 * LANES)));
/* Enough independent chains to hide the latency, few enough for the registers. */
enum { CHAINS = 12 };

/* a = b + factor c; moves 32 bytes per element: two reads, one write, and the read that a write makes. */
EXPORT void triad(int64_t count, double *restrict a, const double *restrict b, const double *restrict c, double factor,
                  int64_t threads) {
#pragma omp parallel for simd schedule(static) num_threads((int)threads)
  for (int64_t n = 0; n < count; ++n) a[n] = b[n] + factor * c[n];
}

/* Chains of one operation on vectors; returns how many scalar operations were done, times `each`. */
#define CHAIN_OPERATION(NAME, OPERATION, EACH)                                                                  \
  EXPORT double NAME(int64_t rounds, int64_t threads, double *sink) {                                           \
    double total = 0.0, kept = 0.0;                                                                             \
    _Pragma("omp parallel num_threads((int)threads) reduction(+ : total, kept)") {                              \
      vector chain[CHAINS], factor, term;                                                                       \
      for (int lane = 0; lane < LANES; ++lane) factor[lane] = 0.999 + 1e-6 * lane, term[lane] = 1.001;          \
      for (int k = 0; k < CHAINS; ++k) chain[k] = factor + (double)k;                                           \
      for (int64_t round = 0; round < rounds; ++round)                                                          \
        for (int k = 0; k < CHAINS; ++k) chain[k] = OPERATION;                                                  \
      for (int k = 0; k < CHAINS; ++k)                                                                          \
        for (int lane = 0; lane < LANES; ++lane) kept += chain[k][lane];                                        \
      total += (double)rounds * CHAINS * LANES * EACH;                                                          \
    }                                                                                                           \
    *sink = kept;                                                                                               \
    return total;                                                                                               \
  }

CHAIN_OPERATION(multiply_adds, chain[k] * factor + term, 2)
CHAIN_OPERATION(divisions, term / chain[k], 1)
