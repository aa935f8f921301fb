#pragma once
// Private to the kit: marks a small loop over the 16 lanes of a packet for the vectorizer and compiles it twice, for
// x86-64-v3 and for the baseline; the processor chooses at load. The sanitizers cannot take functions chosen so early.
// Measured on box_city, where Embree has least to do (gnomon_bench): resolve of embree_rays reaches 0.9 of the throughput of a
// bare loop through Embree, and 0.7 to 0.8 without this.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define GNOMON_VECTORIZED __attribute__((target_clones("arch=x86-64-v3", "default"), optimize("O3")))
#else
#define GNOMON_VECTORIZED
#endif
