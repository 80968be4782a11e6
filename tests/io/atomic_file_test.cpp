// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/atomic_file.hpp"

#include <sys/resource.h>

#include <csignal>

#include "io/io_testing.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

std::size_t files_in(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, ReplacesTheTargetOnlyAtCommit) {
    const TestFolder folder;
    save(folder / "a", "old");
    {
        AtomicFile file(folder / "a");
        file.write("new ");
        file.write("content");
        EXPECT_EQ(load_text(folder / "a"), "old");
        EXPECT_EQ(file.temporary().parent_path(), folder.path());
        file.commit();
        EXPECT_EQ(load_text(folder / "a"), "new content");
    }
    EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
    const TestFolder folder;
    {
        AtomicFile file(folder / "a");
        file.write("half");
    }
    EXPECT_EQ(files_in(folder.path()), 0U);
}

TEST(AtomicFile, KeepsPermissionsAndFollowsLinks) {
    const TestFolder folder;
    save(folder / "a", "old");
    std::filesystem::permissions(folder / "a", std::filesystem::perms(0640));
    std::filesystem::create_symlink("a", folder / "link");
    write_file_atomically(folder / "link", "new");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
    EXPECT_EQ(load_text(folder / "a"), "new");
    EXPECT_EQ(std::filesystem::status(folder / "a").permissions(), std::filesystem::perms(0640));
}

TEST(AtomicFile, PassesOverTemporariesOfKilledProcesses) {
    const TestFolder folder;
    const AtomicFile first(folder / "a");
    write_file_atomically(folder / "a", "second");
    EXPECT_EQ(load_text(folder / "a"), "second");
    EXPECT_TRUE(std::filesystem::exists(first.temporary()));
}

TEST(AtomicFile, SaysWhyItCannotWrite) {
    const TestFolder folder;
    const auto problem = [](const std::filesystem::path& path) {
        try {
            write_file_atomically(path, "x");
        } catch (const FileError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(problem(folder / "no/a"),
              (folder / "no/a").string() + ": can't be written: No such file or directory");
    EXPECT_EQ(problem(folder.path()),
              folder.path().string() + ": can't be written: it is a folder");
    EXPECT_EQ(problem("/dev/null"), "/dev/null: can't be written: not a regular file");
}

// A limit on file size fails in the middle of writing, as a full disk does.
TEST(AtomicFile, AFailedWriteKeepsTheOldTarget) {
    const TestFolder folder;
    save(folder / "a", "old");
    rlimit limit = {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    auto* handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small = {1000, limit.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    std::string message;
    try {
        write_file_atomically(folder / "a", std::string(5000, 'x'));
    } catch (const FileError& error) {
        message = error.what();
    }
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(message, (folder / "a").string() + ": can't be written: File too large");
    EXPECT_EQ(load_text(folder / "a"), "old");
    EXPECT_EQ(files_in(folder.path()), 1U);
}

}  // namespace
}  // namespace ostraka
