// SPDX-License-Identifier: Apache-2.0
// Bag of words: one global row from many local ones, which counts how often each word of a learned
// codebook occurs. Toldo, Castellani, Fusiello. A Bag of Words Approach for 3D Object
// Categorization. MIRAGE 2009.
// Departs from the paper: the words are those of any local descriptor at points spread over the
// piece, not of segmented regions, one codebook for all; and rows are compared after square roots
// (Hellinger), as everywhere in this module. Rooted rows have length 1, so the clustering is the
// spherical k-means of Dhillon, Modha (Concept Decompositions for Large Sparse Text Data Using
// Clustering. Machine Learning 42, 2001), seeded by k-means++ (Arthur, Vassilvitskii. SODA 2007).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ostraka {

/// The words that rows are counted by.
struct Codebook {
    std::size_t length = 0;    ///< floats in a word, as in a row of the local descriptor
    std::vector<float> words;  ///< words x length, row-major: rooted rows of L2 norm 1
    std::size_t size() const { return length == 0 ? 0 : words.size() / length; }
};

struct CodebookSettings {
    std::size_t words = 128;          ///< at most; there are never more than distinct rows
    int iterations = 10;              ///< of k-means, at most; it stops when no row moves
    std::size_t max_samples = 4'096;  ///< rows to learn from, drawn at random if there are more
    std::uint64_t seed = 0;           ///< same seed and rows, same words, any number of threads
};

/// Learns the words that a set of local rows falls into.
/// @param rows    rows x length, row-major, finite, of any scale; rows of 0 are left out. The order
///                of the rows decides which random choices are made.
/// @param length  floats in a row, at least 1.
/// @throws InvalidInput if the length is 0 or doesn't divide the rows, a value is not finite, all
///         rows are 0 (or there are none), or words, iterations or max_samples are not positive.
Codebook learn_codebook(std::span<const float> rows, std::size_t length,
                        const CodebookSettings& settings = {});

/// Counts the nearest word of each row.
/// @param rows      rows x codebook.length, row-major, finite, of any scale; rows of 0 are left
/// out.
/// @param codebook  at least one word.
/// @return codebook.size() floats, non-negative, sum 1; all 0 where no row is left. The same for
///         any order of the rows. Of words equally near the first counts.
/// @throws InvalidInput if the codebook is empty or damaged, its length doesn't divide the rows, or
///         a value is not finite.
std::vector<float> bag_of_words(std::span<const float> rows, const Codebook& codebook);

}  // namespace ostraka
