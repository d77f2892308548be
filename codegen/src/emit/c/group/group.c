
// The values of several states, which fill a register, and their bits. Operators act on each value.
#if !defined(__GNUC__)
#define GELENK_WIDTH 1
#define GELENK_OF_GROUP static inline
typedef double gelenk_group;
typedef uint64_t gelenk_group_bits;
#else
#define GELENK_OF_GROUP static inline __attribute__((always_inline, unused))
#if defined(__AVX512F__)
#define GELENK_WIDTH 8
#elif defined(__AVX__)
#define GELENK_WIDTH 4
#else
#define GELENK_WIDTH 2
#endif
typedef double gelenk_group __attribute__((vector_size(8 * GELENK_WIDTH)));
typedef uint64_t gelenk_group_bits __attribute__((vector_size(8 * GELENK_WIDTH)));
#endif
