
// The values of several states, which fill a register, and their bits. Operators act on each value.
#if !defined(__GNUC__)
#define GELENK_WIDTH 1
#define GELENK_OF_GROUP static inline
typedef float gelenk_group;
typedef uint32_t gelenk_group_bits;
#else
#define GELENK_OF_GROUP static inline __attribute__((always_inline, unused))
#if defined(__AVX__)
#define GELENK_WIDTH 8
#else
#define GELENK_WIDTH 4
#endif
typedef float gelenk_group __attribute__((vector_size(4 * GELENK_WIDTH)));
typedef uint32_t gelenk_group_bits __attribute__((vector_size(4 * GELENK_WIDTH)));
#endif
