// SPDX-License-Identifier: Apache-2.0
// A file that keeps what an evaluation has done, so that it goes on after an interruption.
// One line an item: key, tab, number, tab, text. A line that was cut off is as if it weren't there.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace ostraka {

class Journal {
  public:
    /// @param path  read if it exists; made otherwise. Empty: nothing is kept.
    /// @param key   says all that decides the results; lines of other keys are left alone. No tabs
    ///              or line breaks.
    /// @throws FileError.
    Journal(const std::filesystem::path& path, std::string key);

    /// What was kept of an item.
    std::optional<std::string> find(std::size_t item) const;
    std::size_t size() const { return known_.size(); }
    /// Keeps an item at once. Safe from many threads. @param text  one line.
    /// @throws FileError.
    void add(std::size_t item, const std::string& text);

  private:
    std::filesystem::path path_;
    std::string key_;
    std::map<std::size_t, std::string> known_;
    std::ofstream file_;
    std::mutex mutex_;
};

}  // namespace ostraka
