// SPDX-License-Identifier: Apache-2.0
// Internal to io: what lies in a folder, and names as people compare them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace ostraka {

/// "rs2" before "rs10": runs of digits compare as numbers. A strict order of all texts.
bool natural_less(std::string_view a, std::string_view b);

/// Letters (in lower case) and digits only: "T-rex" and "trex" have the same key.
std::string name_key(std::string_view name);

/// Regular files of the folder and of folders in it to `depth` below, in the natural order of their
/// paths. @param depth  0: the folder alone.
/// @throws FileError if it is no folder or can't be listed, InvalidInput if it holds so many files
/// that it can't be meant.
std::vector<std::filesystem::path> list_files(const std::filesystem::path& folder, int depth);

/// Folders directly in `folder`, in the natural order of their names. @throws as list_files().
std::vector<std::filesystem::path> list_folders(const std::filesystem::path& folder);

/// By its extension: a kind that read_cloud() reads.
bool is_cloud_file(const std::filesystem::path& path);
/// By its extension: a kind that read_mesh() reads.
bool is_mesh_file(const std::filesystem::path& path);

}  // namespace ostraka
