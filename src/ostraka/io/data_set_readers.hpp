// SPDX-License-Identifier: Apache-2.0
// Internal to io: one reader for each kind of data set. Each returns nothing for a folder that is
// not of its kind, and throws FormatError for one that is but is damaged.
#pragma once

#include <optional>
#include <string>

#include "ostraka/io/data_set.hpp"

namespace ostraka {

std::optional<DataSet> open_ostraka(const std::filesystem::path& folder);
std::optional<DataSet> open_bop(const std::filesystem::path& folder);
std::optional<DataSet> open_bologna(const std::filesystem::path& folder);
std::optional<DataSet> open_uwa(const std::filesystem::path& folder);

/// How deep below the folder the files of UWA and Bologna may lie.
inline constexpr int kDataSetDepth = 3;

/// Sorts models by name (natural order) and lets the objects follow.
void sort_models(DataSet& set);

/// The index of the model of that name, which is added if there is none.
std::uint32_t model_of_name(DataSet& set, const std::string& name);

}  // namespace ostraka
