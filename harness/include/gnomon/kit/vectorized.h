#pragma once

// GNOMON_VECTORIZED marks a function whose small loops the compiler is to vectorize. It is compiled for x86-64-v4, for
// x86-64-v3 and for the baseline; the processor chooses at load. The sanitizers cannot take functions chosen so early. No
// result may depend on the choice: the order of every sum is fixed, and nothing is contracted. Measured on box_city, where
// Embree has least to do (gnomon_bench): resolve of embree_rays reaches 0.9 of the throughput of a bare loop through Embree,
// and 0.7 to 0.8 without this.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define GNOMON_VECTORIZED __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), optimize("O3")))
#else
#define GNOMON_VECTORIZED
#endif
