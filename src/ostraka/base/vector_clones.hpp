// SPDX-License-Identifier: Apache-2.0
// Functions compiled twice, for any x86-64 and for AVX2 machines, and
// chosen when the program starts. Without contraction and reassociation both give the same bits.
#pragma once

#include <cstdint>
#include <cstring>

// Sanitizers can't run in the resolvers, which start before them.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OSTRAKA_VECTOR_CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
// For a function written twice, where compilers don't find the instruction by themselves.
#define OSTRAKA_HAS_AVX2_CLONES 1
#define OSTRAKA_DEFAULT_CLONE __attribute__((target("default")))
#define OSTRAKA_AVX2_CLONE __attribute__((target("arch=x86-64-v3")))
#else
#define OSTRAKA_VECTOR_CLONES
#define OSTRAKA_HAS_AVX2_CLONES 0
#define OSTRAKA_DEFAULT_CLONE
#endif

namespace ostraka {

// Eight values side by side, for loops that compilers don't vectorize by themselves. Without AVX
// they become pairs of SSE vectors. Only for local variables.
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));
using Word8 = std::uint32_t __attribute__((vector_size(32)));
using Double4 = double __attribute__((vector_size(32)));
inline constexpr std::size_t kVectorLanes = 8;

__attribute__((always_inline)) inline void load8(const float* from, Float8& to) {
    std::memcpy(&to, from, sizeof(to));
}
__attribute__((always_inline)) inline void load8(const std::uint32_t* from, Word8& to) {
    std::memcpy(&to, from, sizeof(to));
}
__attribute__((always_inline)) inline void load4(const double* from, Double4& to) {
    std::memcpy(&to, from, sizeof(to));
}

}  // namespace ostraka
