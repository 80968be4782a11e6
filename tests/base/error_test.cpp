// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/error.hpp"

#include <gtest/gtest.h>

namespace ostraka {
namespace {

TEST(Error, MessagesAreOneLineWithPathAndPosition) {
    EXPECT_STREQ(FileError("a/b.ply", "cannot be opened").what(), "a/b.ply: cannot be opened");
    EXPECT_STREQ(FormatError("b.stl", "byte 80", "expected a count").what(),
                 "b.stl: byte 80: expected a count");
    EXPECT_STREQ(InvalidInput("the cloud is empty").what(), "the cloud is empty");
}

TEST(Error, AllAreCaughtAsErrorAndAsStandardException) {
    EXPECT_THROW(throw InvalidInput("x"), Error);
    EXPECT_THROW(throw FileError("x", "y"), Error);
    EXPECT_THROW(throw FormatError("x", "y", "z"), Error);
    EXPECT_THROW(throw Interrupted(), Error);
    EXPECT_THROW(throw Error("x"), std::runtime_error);
}

}  // namespace
}  // namespace ostraka
