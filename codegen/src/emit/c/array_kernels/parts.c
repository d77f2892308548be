// Number of columns of a part of a row, which fills a register.
#if defined(__GNUC__) && defined(__AVX512F__) && GELENK_K == 8
#define GELENK_PART 8
#elif defined(__GNUC__) && defined(__AVX__)
#define GELENK_PART 4
#elif defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define GELENK_PART 2
#else
#define GELENK_PART 1
#endif
