#pragma once
/// CUESTA_VECTOR_CLONES before a function: compiled for AVX-512, AVX2 and any x86-64; the processor
/// chooses. One source and the same IEEE operations in the same order: the result does not depend on the
/// machine (I6).

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__clang__)
#define CUESTA_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define CUESTA_VECTOR_CLONES
#endif
