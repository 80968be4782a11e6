// SPDX-License-Identifier: Apache-2.0
// Private to this module: functions compiled twice, for any x86-64 and for AVX2 machines, and
// chosen when the program starts. Without contraction and reassociation both give the same bits.
#pragma once

// Sanitizers can't run in the resolvers, which start before them.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OSTRAKA_CLOUD_CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define OSTRAKA_CLOUD_CLONES
#endif
