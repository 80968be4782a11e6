// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/label_text.hpp"

#include <gtest/gtest.h>

namespace ostraka {
namespace {

const std::string kEllipsis = "\xE2\x80\xA6";

TEST(LabelText, WidthGrowsWithSizeAndLength) {
    EXPECT_EQ(label_width("", 12.0), 0.0);
    EXPECT_GT(label_width("mm", 12.0), label_width("ii", 12.0));
    EXPECT_DOUBLE_EQ(label_width("abc", 24.0), 2.0 * label_width("abc", 12.0));
    EXPECT_EQ(label_width("\xC3\xA4", 12.0), label_width("a", 12.0));
}

TEST(LabelText, ShortensOnlyWhatIsTooLong) {
    EXPECT_EQ(shortened_label("bracket", 12.0, 100.0), "bracket");
    const std::string shown = shortened_label("a very long bracket name", 12.0, 80.0);
    EXPECT_TRUE(shown.ends_with(kEllipsis));
    EXPECT_LE(label_width(shown, 12.0), 80.0 + 12.0);
    EXPECT_EQ(shortened_label("bracket", 12.0, 0.0), kEllipsis);
}

TEST(LabelText, ShorteningKeepsCharactersWhole) {
    std::string umlauts;
    for (int i = 0; i < 30; ++i) umlauts += "\xC3\xA4";
    for (double width = 0.0; width < 100.0; width += 1.0) {
        const std::string shown = shortened_label(umlauts, 12.0, width);
        EXPECT_EQ((shown.size() - kEllipsis.size()) % 2, 0U) << width;
    }
}

TEST(LabelText, WrapsAtSpacesUnderscoresAndHyphens) {
    using Lines = std::vector<std::string>;
    EXPECT_EQ(wrapped_label("one", 12.0, 100.0, 2), Lines({"one"}));
    EXPECT_EQ(wrapped_label("first second", 12.0, 50.0, 2), Lines({"first", "second"}));
    EXPECT_EQ(wrapped_label("first_second", 12.0, 50.0, 2), Lines({"first_", "second"}));
    EXPECT_EQ(wrapped_label("", 12.0, 50.0, 2), Lines({""}));
    const Lines lines = wrapped_label("one two three four five six", 12.0, 50.0, 2);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_TRUE(lines[1].ends_with(kEllipsis));
    EXPECT_EQ(wrapped_label("unbreakableword and more", 12.0, 50.0, 2).size(), 1U);
}

}  // namespace
}  // namespace ostraka
