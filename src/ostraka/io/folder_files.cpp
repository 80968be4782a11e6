// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/folder_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t kMostItems = 200'000;

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// Takes the digits at the front of `text` off, and the zeros that lead them.
std::string_view take_digits(std::string_view& text) {
    std::size_t end = 0;
    while (end < text.size() && is_digit(text[end])) ++end;
    std::string_view digits = text.substr(0, end);
    text.remove_prefix(end);
    while (digits.size() > 1 && digits[0] == '0') digits.remove_prefix(1);
    return digits;
}

// Adds what lies directly in `folder`.
void append_items(const Path& folder, std::vector<Path>& files, std::vector<Path>& folders) {
    std::error_code problem;
    std::filesystem::directory_iterator item(folder, problem);
    for (; !problem && item != std::filesystem::directory_iterator(); item.increment(problem)) {
        std::error_code ignored;  // a broken link is neither
        if (item->is_regular_file(ignored)) files.push_back(item->path());
        if (item->is_directory(ignored)) folders.push_back(item->path());
        if (files.size() + folders.size() > kMostItems) {
            throw InvalidInput(
                fmt::format("{}: holds more than {} files; name the folder of the "
                            "data set itself",
                            folder.string(), kMostItems));
        }
    }
    if (problem) throw FileError(folder, "can't be listed: " + problem.message());
}

void sort_naturally(std::vector<Path>& paths) {
    std::sort(paths.begin(), paths.end(),
              [](const Path& a, const Path& b) { return natural_less(a.native(), b.native()); });
}

template <std::size_t N>
bool has_extension(const Path& path, const std::array<const char*, N>& extensions) {
    const std::string own = lower_extension(path);
    return std::find(extensions.begin(), extensions.end(), own) != extensions.end();
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
    const std::string_view whole_a = a;
    const std::string_view whole_b = b;
    while (!a.empty() && !b.empty()) {
        if (is_digit(a[0]) && is_digit(b[0])) {
            const std::string_view x = take_digits(a);
            const std::string_view y = take_digits(b);
            if (x.size() != y.size()) return x.size() < y.size();
            if (x != y) return x < y;
        } else {
            if (a[0] != b[0])
                return static_cast<unsigned char>(a[0]) < static_cast<unsigned char>(b[0]);
            a.remove_prefix(1);
            b.remove_prefix(1);
        }
    }
    if (a.empty() != b.empty()) return a.empty();
    return whole_a < whole_b;  // they differ in leading zeros only
}

std::string name_key(std::string_view name) {
    std::string key;
    for (const char c : name) {
        if (c >= 'A' && c <= 'Z') key += static_cast<char>(c - 'A' + 'a');
        if ((c >= 'a' && c <= 'z') || is_digit(c)) key += c;
    }
    return key;
}

std::vector<Path> list_files(const Path& folder, int depth) {
    std::vector<Path> files;
    std::vector<Path> folders = {folder};
    for (int level = 0; level <= depth; ++level) {
        const std::vector<Path> now = std::move(folders);
        folders.clear();
        for (const Path& path : now) append_items(path, files, folders);
    }
    sort_naturally(files);
    return files;
}

std::vector<Path> list_folders(const Path& folder) {
    std::vector<Path> files;
    std::vector<Path> folders;
    append_items(folder, files, folders);
    sort_naturally(folders);
    return folders;
}

bool is_cloud_file(const Path& path) {
    constexpr std::array kExtensions = {".ply", ".pcd", ".xyz", ".txt", ".asc"};
    return has_extension(path, kExtensions);
}

bool is_mesh_file(const Path& path) {
    constexpr std::array kExtensions = {".ply", ".obj", ".stl", ".off", ".gltf", ".glb"};
    return has_extension(path, kExtensions);
}

}  // namespace ostraka
