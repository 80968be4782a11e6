// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/sha256.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <fstream>
#include <vector>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// FIPS 180-4, section 4.2.2: first 32 bits of the fractional parts of the cube roots of the primes.
constexpr std::array<std::uint32_t, 64> kRoundConstants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

using State = std::array<std::uint32_t, 8>;

void hash_block(State& state, const unsigned char* block) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t t = 0; t < 16; ++t) {
        w[t] = std::uint32_t{block[4 * t]} << 24U | std::uint32_t{block[4 * t + 1]} << 16U |
               std::uint32_t{block[4 * t + 2]} << 8U | std::uint32_t{block[4 * t + 3]};
    }
    for (std::size_t t = 16; t < 64; ++t) {
        const std::uint32_t a = w[t - 15];
        const std::uint32_t b = w[t - 2];
        w[t] = w[t - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3U)) + w[t - 7] +
               (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10U));
    }
    State s = state;
    for (std::size_t t = 0; t < 64; ++t) {
        const std::uint32_t choose = (s[4] & s[5]) ^ (~s[4] & s[6]);
        const std::uint32_t t1 = s[7] +
                                 (std::rotr(s[4], 6) ^ std::rotr(s[4], 11) ^ std::rotr(s[4], 25)) +
                                 choose + kRoundConstants[t] + w[t];
        const std::uint32_t majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]);
        const std::uint32_t t2 =
            (std::rotr(s[0], 2) ^ std::rotr(s[0], 13) ^ std::rotr(s[0], 22)) + majority;
        s = {t1 + t2, s[0], s[1], s[2], s[3] + t1, s[4], s[5], s[6]};
    }
    for (std::size_t i = 0; i < 8; ++i) state[i] += s[i];
}

#if defined(__x86_64__)
// Four rounds at a time by the processor. The state lies in two registers, as ABEF and CDGH.
__attribute__((target("sha,sse4.1"))) void hash_blocks_by_processor(State& state,
                                                                    const unsigned char* bytes,
                                                                    std::size_t blocks) {
    const __m128i swap = _mm_set_epi64x(0x0c0d0e0f08090a0bLL, 0x0405060700010203LL);
    const auto load = [](const void* from) {
        return _mm_loadu_si128(static_cast<const __m128i*>(from));
    };
    const __m128i cdab = _mm_shuffle_epi32(load(state.data()), 0xB1);
    const __m128i efgh = _mm_shuffle_epi32(load(state.data() + 4), 0x1B);
    __m128i abef = _mm_alignr_epi8(cdab, efgh, 8);
    __m128i cdgh = _mm_blend_epi16(efgh, cdab, 0xF0);
    for (; blocks > 0; --blocks, bytes += 64) {
        const __m128i abef_before = abef;
        const __m128i cdgh_before = cdgh;
        __m128i w[4];  // std::array would drop the vectors' attributes
        for (std::size_t i = 0; i < 4; ++i) w[i] = _mm_shuffle_epi8(load(bytes + 16 * i), swap);
        for (std::size_t group = 0; group < 16; ++group) {
            const __m128i sum =
                _mm_add_epi32(w[group % 4], load(kRoundConstants.data() + 4 * group));
            cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
            abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0E));
            if (group >= 12) continue;
            // w[t] for the group after the next three.
            const __m128i& w1 = w[(group + 1) % 4];
            const __m128i& w2 = w[(group + 2) % 4];
            const __m128i& w3 = w[(group + 3) % 4];
            const __m128i next =
                _mm_add_epi32(_mm_sha256msg1_epu32(w[group % 4], w1), _mm_alignr_epi8(w3, w2, 4));
            w[group % 4] = _mm_sha256msg2_epu32(next, w3);
        }
        abef = _mm_add_epi32(abef, abef_before);
        cdgh = _mm_add_epi32(cdgh, cdgh_before);
    }
    const __m128i feba = _mm_shuffle_epi32(abef, 0x1B);
    const __m128i dchg = _mm_shuffle_epi32(cdgh, 0xB1);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data()), _mm_blend_epi16(feba, dchg, 0xF0));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data() + 4), _mm_alignr_epi8(dchg, feba, 8));
}

// GCC 12's __builtin_cpu_supports doesn't know "sha": leaf 7, bit 29 of EBX.
bool processor_has_sha() {
    static const bool has = [] {
        unsigned a = 0;
        unsigned b = 0;
        unsigned c = 0;
        unsigned d = 0;
        return __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (b >> 29U & 1U) != 0 &&
               __builtin_cpu_supports("sse4.1") != 0;
    }();
    return has;
}
#endif

void hash_blocks(State& state, const unsigned char* bytes, std::size_t blocks) {
#if defined(__x86_64__)
    if (processor_has_sha()) return hash_blocks_by_processor(state, bytes, blocks);
#endif
    for (; blocks > 0; --blocks, bytes += 64) hash_block(state, bytes);
}

}  // namespace

void Sha256::add(std::span<const unsigned char> bytes) {
    size_ += bytes.size();
    if (pending_ > 0) {
        const std::size_t taken = std::min(bytes.size(), block_.size() - pending_);
        std::copy_n(bytes.begin(), taken, block_.begin() + static_cast<std::ptrdiff_t>(pending_));
        bytes = bytes.subspan(taken);
        pending_ += taken;
        if (pending_ < block_.size()) return;
        hash_blocks(state_, block_.data(), 1);
    }
    hash_blocks(state_, bytes.data(), bytes.size() / 64);
    bytes = bytes.subspan(bytes.size() / 64 * 64);
    std::copy(bytes.begin(), bytes.end(), block_.begin());
    pending_ = bytes.size();
}

std::string Sha256::finish() {
    const std::uint64_t bit_count = size_ * 8;
    std::vector<unsigned char> tail(1, 0x80);
    while ((pending_ + tail.size()) % 64 != 56) tail.push_back(0);
    for (int shift = 56; shift >= 0; shift -= 8) {
        tail.push_back(static_cast<unsigned char>(bit_count >> static_cast<unsigned>(shift)));
    }
    add(tail);
    std::string text;
    for (const std::uint32_t word : state_) {
        for (int shift = 28; shift >= 0; shift -= 4) {
            text += "0123456789abcdef"[(word >> static_cast<unsigned>(shift)) & 15U];
        }
    }
    return text;
}

std::string sha256(std::span<const unsigned char> bytes) {
    Sha256 digest;
    digest.add(bytes);
    return digest.finish();
}

std::string sha256_of_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw FileError(path, "cannot be opened");
    Sha256 digest;
    std::vector<unsigned char> chunk(std::size_t{1} << 20U);
    while (file) {
        file.read(reinterpret_cast<char*>(chunk.data()),
                  static_cast<std::streamsize>(chunk.size()));
        digest.add(std::span(chunk).first(static_cast<std::size_t>(file.gcount())));
    }
    // A folder, too, can be opened; reading it fails.
    if (file.bad()) throw FileError(path, "cannot be read");
    return digest.finish();
}

}  // namespace ostraka
