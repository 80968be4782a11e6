// SPDX-License-Identifier: Apache-2.0
// The library's bag of words (descriptors/bag_of_words.hpp) over the SHOT rows of its keypoints.
// Made of what a library file holds and of nothing else, so that a library put together from others
// gets the same words and bags as one built at once.
#pragma once

#include <string_view>

#include "ostraka/library/model_library.hpp"

namespace ostraka {

/// The name by which classify() knows it.
inline constexpr std::string_view kBagOfWords = "bag_of_words";

/// Points that an entry is described at, and a segment.
inline constexpr std::size_t kEntryBagKeypoints = 64;
inline constexpr std::size_t kSegmentBagKeypoints = 200;

/// Learns the codebook from all models' keypoints, each model with the same number of rows at most,
/// and counts its words in every entry. Replaces what the library had; no codebook without
/// keypoints.
void make_bags(ModelLibrary& library);

/// @param cloud  with normals, at the library's sampling distance, library unit.
/// @param most   keypoints, spread over the cloud.
/// @return library.codebook.size() floats, sum 1; all 0 where no keypoint has a row.
/// @throws InvalidInput if the library has no codebook.
std::vector<float> describe_bag(const PointCloud& cloud, const ModelLibrary& library,
                                std::size_t most);

}  // namespace ostraka
