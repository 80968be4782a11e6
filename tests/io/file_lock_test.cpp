// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/file_lock.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "io_testing.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

namespace fs = std::filesystem;
using io_testing::load_text;
using io_testing::save;
using io_testing::TestFolder;

std::string problem(const fs::path& path) {
    try {
        const FileLock lock(path);
    } catch (const FileError& error) {
        return error.what();
    }
    return "";
}

TEST(FileLock, KeepsOthersOutUntilItEnds) {
    const TestFolder folder;
    const fs::path path = folder / "a";
    std::optional<FileLock> lock(path);
    EXPECT_EQ(problem(path), path.string() + ": another process is writing to it");
    lock.reset();
    EXPECT_EQ(problem(path), "");
    EXPECT_TRUE(fs::exists(path));
}

TEST(FileLock, KeepsWhatIsInTheFile) {
    const TestFolder folder;
    save(folder / "a", "content");
    EXPECT_EQ(problem(folder / "a"), "");
    EXPECT_EQ(load_text(folder / "a"), "content");
}

TEST(FileLock, ARemovedFileIsNobodys) {
    const TestFolder folder;
    const FileLock first(folder / "a");
    fs::remove(folder / "a");
    const FileLock second(folder / "a");
    EXPECT_EQ(problem(folder / "a"),
              (folder / "a").string() + ": another process is writing to it");
}

TEST(FileLock, SaysWhyAFileCantBeOpened) {
    const TestFolder folder;
    EXPECT_EQ(problem(folder / "no/a"),
              (folder / "no/a").string() + ": can't be written: No such file or directory");
}

}  // namespace
}  // namespace ostraka
