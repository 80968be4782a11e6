// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/progress.hpp"

#include <gtest/gtest.h>

#include <string>

namespace ostraka {
namespace {

TEST(Progress, HandsOnStageAndCounts) {
    std::string seen;
    const Progress progress = [&](std::string_view stage, std::size_t done, std::size_t total) {
        seen = std::string(stage) + " " + std::to_string(done) + "/" + std::to_string(total);
        return true;
    };
    report(progress, "views", 3, 42);
    EXPECT_EQ(seen, "views 3/42");
}

TEST(Progress, FalseInterrupts) {
    const Progress stop = [](std::string_view, std::size_t, std::size_t) { return false; };
    EXPECT_THROW(report(stop, "views", 0, 1), Interrupted);
}

TEST(Progress, NoCallbackIsFine) {
    EXPECT_NO_THROW(report({}, "views", 0, 1));
}

}  // namespace
}  // namespace ostraka
