// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/bag_of_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/lane_sums.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/metric.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kGrain = 64;       // rows that a thread takes at a time
constexpr double kSameRow = 1e-6;        // squared distance below which two rooted rows are one
constexpr std::uint32_t kUnknown = ~0U;  // no word yet

// The cosine of the angle between rows of length 1.
OSTRAKA_VECTOR_CLONES float dot(const float* a, const float* b, std::size_t length) {
    return sum_in_lanes<16>(a, b, length, [](float x, float y) { return x * y; });
}

void check_rows(std::span<const float> rows, std::size_t length) {
    if (length == 0) throw InvalidInput("bag of words: rows have no length");
    if (rows.size() % length != 0) {
        throw InvalidInput(
            fmt::format("bag of words: {} values are no rows of {}", rows.size(), length));
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (std::isfinite(rows[i])) continue;
        throw InvalidInput(fmt::format("bag of words: row {} is not finite", i / length));
    }
}

// Numbers of the rows that are not 0.
std::vector<std::size_t> defined_rows(std::span<const float> rows, std::size_t length) {
    std::vector<std::size_t> defined;
    for (std::size_t i = 0; i < rows.size() / length; ++i) {
        const auto row = rows.subspan(i * length, length);
        if (std::any_of(row.begin(), row.end(), [](float v) { return v != 0.0F; })) {
            defined.push_back(i);
        }
    }
    return defined;
}

// The chosen rows, rooted: each of L2 norm 1.
std::vector<float> rooted(std::span<const float> rows, std::size_t length,
                          std::span<const std::size_t> chosen) {
    std::vector<float> result(chosen.size() * length);
    parallel_for(
        chosen.size(),
        [&](std::size_t i) {
            const std::vector<float> row =
                comparable_row(rows.subspan(chosen[i] * length, length), Metric::hellinger);
            std::copy(row.begin(), row.end(),
                      result.begin() + static_cast<std::ptrdiff_t>(i * length));
        },
        kGrain);
    return result;
}

// k-means over rooted rows, which all have length 1.
class Clustering {
  public:
    Clustering(std::vector<float> rows, std::size_t length, std::uint64_t seed)
        : rows_(std::move(rows)),
          length_(length),
          random_(seed),
          apart_(rows_.size() / length, 4.0),
          word_of_(apart_.size(), kUnknown) {}

    // k-means++: each next word is a row, drawn by its squared distance from the nearest word.
    void seed_words(std::size_t count) {
        add_word(random_.below(static_cast<std::uint32_t>(apart_.size())));
        while (words_.size() < count * length_) {
            const double sum = std::accumulate(apart_.begin(), apart_.end(), 0.0);
            if (!(sum > 0.0)) return;  // every row is a word
            double left = random_.uniform() * sum;
            std::size_t row = apart_.size();
            for (std::size_t i = 0; i < apart_.size() && left >= 0.0; ++i) {
                if (apart_[i] == 0.0) continue;
                row = i;
                left -= apart_[i];
            }
            add_word(row);
        }
    }

    // Gives each row its nearest word. @return whether any row changed its word.
    bool assign() {
        std::vector<std::uint32_t> nearest(word_of_.size());
        parallel_for(
            nearest.size(),
            [&](std::size_t i) {
                const float* row = rows_.data() + i * length_;
                const Likeness best = most_alike(row, words_, length_);
                nearest[i] = best.word;
                apart_[i] = squared_distance(best.cosine);
            },
            kGrain);
        const bool changed = nearest != word_of_;
        word_of_ = std::move(nearest);
        return changed;
    }

    // Moves each word to the middle of its rows; one without rows to the row farthest from its own
    // word, each row at most once.
    void update() {
        const std::size_t count = words_.size() / length_;
        std::vector<std::vector<std::uint32_t>> members(count);
        for (std::uint32_t i = 0; i < word_of_.size(); ++i) members[word_of_[i]].push_back(i);
        parallel_for(count, [&](std::size_t w) { move_word(w, members[w]); });
        for (std::size_t w = 0; w < count; ++w) {
            if (!members[w].empty()) continue;
            const auto farthest = std::max_element(apart_.begin(), apart_.end());
            if (*farthest == 0.0) return;
            const auto row = static_cast<std::size_t>(farthest - apart_.begin());
            *farthest = 0.0;
            std::copy_n(rows_.data() + row * length_, length_, words_.data() + w * length_);
        }
    }

    std::vector<float> take_words() { return std::move(words_); }

    struct Likeness {
        std::uint32_t word = 0;
        float cosine = -2.0F;
    };
    static Likeness most_alike(const float* row, std::span<const float> words, std::size_t length) {
        Likeness best;
        for (std::uint32_t w = 0; w < words.size() / length; ++w) {
            const float cosine = dot(row, words.data() + w * length, length);
            if (cosine > best.cosine) best = {w, cosine};
        }
        return best;
    }

  private:
    // 0 where rounding is all that sets them apart.
    static double squared_distance(float cosine) {
        const double squared = 2.0 - 2.0 * double{cosine};
        return squared > kSameRow ? squared : 0.0;
    }

    void add_word(std::size_t row) {
        const float* word = rows_.data() + row * length_;
        words_.insert(words_.end(), word, word + length_);
        parallel_for(
            apart_.size(),
            [&](std::size_t i) {
                const float cosine = dot(rows_.data() + i * length_, word, length_);
                apart_[i] = std::min(apart_[i], squared_distance(cosine));
            },
            kGrain);
        apart_[row] = 0.0;
    }

    void move_word(std::size_t w, std::span<const std::uint32_t> members) {
        std::vector<double> sum(length_, 0.0);
        for (const std::uint32_t i : members) {
            const float* row = rows_.data() + std::size_t{i} * length_;
            for (std::size_t j = 0; j < length_; ++j) sum[j] += double{row[j]};
        }
        double squared = 0.0;
        for (const double value : sum) squared += value * value;
        if (!(squared > 0.0)) return;  // no rows, or signed ones that cancel out: it stays
        const double scale = 1.0 / std::sqrt(squared);
        for (std::size_t j = 0; j < length_; ++j) {
            words_[w * length_ + j] = static_cast<float>(sum[j] * scale);
        }
    }

    std::vector<float> rows_;  // rooted
    std::size_t length_;
    Random random_;
    std::vector<double> apart_;           // per row: squared distance from its nearest word
    std::vector<std::uint32_t> word_of_;  // per row
    std::vector<float> words_;
};

// At most `most` of the numbers, drawn at random and left in their order.
std::vector<std::size_t> sampled(std::vector<std::size_t> numbers, std::size_t most,
                                 std::uint64_t seed) {
    if (numbers.size() <= most) return numbers;
    Random random(seed, 1);
    for (std::size_t i = 0; i < most; ++i) {
        const auto left = static_cast<std::uint32_t>(numbers.size() - i);
        std::swap(numbers[i], numbers[i + random.below(left)]);
    }
    numbers.resize(most);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

}  // namespace

Codebook learn_codebook(std::span<const float> rows, std::size_t length,
                        const CodebookSettings& settings) {
    check_rows(rows, length);
    if (settings.words < 1 || settings.iterations < 1 || settings.max_samples < 1) {
        throw InvalidInput("bag of words: words, iterations and samples must be positive");
    }
    if (rows.size() / length >= kUnknown) throw InvalidInput("bag of words: too many rows");
    const std::vector<std::size_t> chosen =
        sampled(defined_rows(rows, length), settings.max_samples, settings.seed);
    if (chosen.empty()) throw InvalidInput("bag of words: there are no rows to learn from");
    Clustering clustering(rooted(rows, length, chosen), length, settings.seed);
    clustering.seed_words(settings.words);
    for (int i = 0; i < settings.iterations && clustering.assign(); ++i) clustering.update();
    return {length, clustering.take_words()};
}

std::vector<float> bag_of_words(std::span<const float> rows, const Codebook& codebook) {
    check_rows(codebook.words, codebook.length);
    if (codebook.size() == 0) throw InvalidInput("bag of words: the codebook has no words");
    check_rows(rows, codebook.length);
    const std::vector<std::size_t> defined = defined_rows(rows, codebook.length);
    const std::vector<float> comparable = rooted(rows, codebook.length, defined);
    std::vector<std::uint32_t> words(defined.size());
    parallel_for(
        words.size(),
        [&](std::size_t i) {
            const float* row = comparable.data() + i * codebook.length;
            words[i] = Clustering::most_alike(row, codebook.words, codebook.length).word;
        },
        kGrain);
    std::vector<double> counts(codebook.size(), 0.0);
    for (const std::uint32_t word : words) counts[word] += 1.0;
    std::vector<float> histogram(counts.size(), 0.0F);
    if (words.empty()) return histogram;
    for (std::size_t w = 0; w < counts.size(); ++w) {
        histogram[w] = static_cast<float>(counts[w] / static_cast<double>(words.size()));
    }
    return histogram;
}

}  // namespace ostraka
