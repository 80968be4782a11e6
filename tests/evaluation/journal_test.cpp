// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/journal.hpp"

#include <gtest/gtest.h>

#include "io/io_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TEST(Journal, KeepsItemsByNumber) {
    const TestFolder folder;
    {
        Journal journal(folder / "journal", "key");
        EXPECT_EQ(journal.size(), 0U);
        journal.add(7, "seven\twith a tab");
        journal.add(0, "");
    }
    const Journal journal(folder / "journal", "key");
    EXPECT_EQ(journal.size(), 2U);
    EXPECT_EQ(journal.find(7), "seven\twith a tab");
    EXPECT_EQ(journal.find(0), "");
    EXPECT_FALSE(journal.find(1).has_value());
}

TEST(Journal, WithoutAFileNothingIsKept) {
    Journal journal("", "key");
    journal.add(1, "one");
    EXPECT_EQ(journal.size(), 0U);
    EXPECT_FALSE(journal.find(1).has_value());
}

// A crash may leave any part of the last line.
TEST(Journal, GoesOnAfterALineCutOffAtEveryLength) {
    const TestFolder folder;
    {
        Journal journal(folder / "whole", "my key");
        journal.add(0, "zero");
        journal.add(1, "one");
        journal.add(12, "twelve");
    }
    const std::string whole = load_text(folder / "whole");
    for (std::size_t length = 0; length <= whole.size(); ++length) {
        const std::string left = whole.substr(0, length);
        const auto lines = static_cast<std::size_t>(std::count(left.begin(), left.end(), '\n'));
        save(folder / "cut", left);
        {
            Journal journal(folder / "cut", "my key");
            ASSERT_EQ(journal.size(), lines) << length;
            ASSERT_EQ(journal.find(0).has_value(), lines > 0);
            ASSERT_EQ(journal.find(12).has_value(), lines > 2);
            journal.add(5, "five");
        }
        const Journal again(folder / "cut", "my key");
        ASSERT_EQ(again.size(), lines + 1) << length;
        ASSERT_EQ(again.find(5), "five") << length;
        if (lines > 1) {
            ASSERT_EQ(again.find(1), "one") << length;
        }
    }
}

TEST(Journal, LeavesOtherKeysAlone) {
    const TestFolder folder;
    const std::string others =
        "key 2\t3\tof another run\n"
        "key\n"
        "\n"
        "key\tnot a number\tx\n"
        "key\t4\n"
        "key\t99999999999999999999999999\tx\n"
        "ke\t1\tx\n";
    save(folder / "journal", others);
    {
        Journal journal(folder / "journal", "key");
        EXPECT_EQ(journal.size(), 0U);
        journal.add(3, "mine");
    }
    EXPECT_EQ(load_text(folder / "journal"), others + "key\t3\tmine\n");
    EXPECT_EQ(Journal(folder / "journal", "key").find(3), "mine");
    EXPECT_EQ(Journal(folder / "journal", "key 2").find(3), "of another run");
}

TEST(Journal, LinesOfManyThreadsAreWhole) {
    const TestFolder folder;
    set_thread_count(4);
    {
        Journal journal(folder / "journal", "key");
        parallel_for(500, [&](std::size_t i) { journal.add(i, std::string(i, 'x')); });
    }
    set_thread_count(0);
    const Journal journal(folder / "journal", "key");
    ASSERT_EQ(journal.size(), 500U);
    for (std::size_t i = 0; i < 500; ++i) ASSERT_EQ(journal.find(i), std::string(i, 'x'));
}

TEST(Journal, AFileThatCannotBeMadeIsAnError) {
    const TestFolder folder;
    EXPECT_THROW(Journal(folder / "no/folder/journal", "key"), FileError);
    EXPECT_THROW(Journal(folder.path(), "key"), FileError);
}

}  // namespace
}  // namespace ostraka
