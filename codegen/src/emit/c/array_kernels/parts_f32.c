// As many columns of a row as a register holds, and their bits. Operators work on each of them.
#if defined(__GNUC__) && defined(__AVX__) && GELENK_K == 8
#define GELENK_PART 8
#elif defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define GELENK_PART 4
#else
#define GELENK_PART 1
#endif
#if GELENK_PART == 1
typedef float gelenk_part;
typedef uint32_t gelenk_part_bits;
#else
typedef float gelenk_part __attribute__((vector_size(4 * GELENK_PART)));
typedef uint32_t gelenk_part_bits __attribute__((vector_size(4 * GELENK_PART)));
#endif
