// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/journal.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "ostraka/base/error.hpp"

namespace ostraka {

Journal::Journal(const std::filesystem::path& path, std::string key)
    : path_(path), key_(std::move(key)) {
    if (path.empty()) return;
    std::uintmax_t whole = 0;  // bytes up to the end of the last whole line
    if (std::filesystem::exists(path)) {
        if (std::filesystem::is_directory(path)) throw FileError(path, "is a folder");
        std::ifstream existing(path, std::ios::binary);
        if (!existing) throw FileError(path, "can't be read");
        const std::string text{std::istreambuf_iterator<char>(existing), {}};
        for (std::size_t start = 0; start < text.size();) {
            const std::size_t end = text.find('\n', start);
            if (end == std::string_view::npos) break;
            const std::string_view line = std::string_view(text).substr(start, end - start);
            start = end + 1;
            whole = start;
            const std::size_t first = line.find('\t');
            if (line.substr(0, first) != key_ || first == std::string_view::npos) continue;
            std::size_t item = 0;
            const auto [stop, problem] =
                std::from_chars(line.data() + first + 1, line.data() + line.size(), item);
            if (problem != std::errc() || stop == line.data() + line.size() || *stop != '\t') {
                continue;
            }
            known_[item] = std::string(stop + 1, line.data() + line.size());
        }
        std::error_code failed;
        std::filesystem::resize_file(path, whole, failed);
        if (failed) throw FileError(path, failed.message());
    }
    file_.open(path, std::ios::binary | std::ios::app);
    if (!file_) throw FileError(path, "can't be written");
}

std::optional<std::string> Journal::find(std::size_t item) const {
    const auto found = known_.find(item);
    return found == known_.end() ? std::nullopt : std::optional(found->second);
}

void Journal::add(std::size_t item, const std::string& text) {
    if (!file_.is_open()) return;
    const std::scoped_lock lock(mutex_);
    file_ << key_ << '\t' << item << '\t' << text << '\n' << std::flush;
    if (!file_) throw FileError(path_, "can't be written");
}

}  // namespace ostraka
