// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/markup.hpp"

#include <gtest/gtest.h>

namespace ostraka {
namespace {

const std::string kUnknown = "\xEF\xBF\xBD";

TEST(Markup, EscapesWhatWouldBeMarkup) {
    EXPECT_EQ(escape_html("<script>alert('a' & \"b\")</script>"),
              "&lt;script&gt;alert(&#39;a&#39; &amp; &quot;b&quot;)&lt;/script&gt;");
    EXPECT_EQ(escape_html("&lt;"), "&amp;lt;");
    EXPECT_EQ(escape_html(""), "");
}

TEST(Markup, KeepsUtf8) {
    const std::string text = "\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x98\x80 tab\tline\n";
    EXPECT_EQ(escape_html(text), text);
}

TEST(Markup, ReplacesWhatXmlCannotHold) {
    EXPECT_EQ(escape_html(std::string_view("a\0b", 3)), "a" + kUnknown + "b");
    EXPECT_EQ(escape_html("\x1b[0m\r\x7F"), kUnknown + "[0m" + kUnknown + kUnknown);
    EXPECT_EQ(escape_html("\xff"), kUnknown);                                // never in UTF-8
    EXPECT_EQ(escape_html("\xC3"), kUnknown);                                // cut off
    EXPECT_EQ(escape_html("\xC3<"), kUnknown + "&lt;");                      // must not eat the <
    EXPECT_EQ(escape_html("\xC0\xBC"), kUnknown + kUnknown);                 // overlong <
    EXPECT_EQ(escape_html("\xED\xA0\x80"), kUnknown + kUnknown + kUnknown);  // surrogate
    EXPECT_EQ(escape_html("\xEF\xBF\xBF"), kUnknown + kUnknown + kUnknown);  // U+FFFF
    EXPECT_EQ(escape_html("\xF4\x90\x80\x80").size(), 4 * kUnknown.size());  // beyond U+10FFFF
}

TEST(Markup, Base64GivesTheVectorsOfRfc4648) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foob"), "Zm9vYg==");
    EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64(std::string_view("\xff\xfe\xfd\x00", 4)), "//79AA==");
    EXPECT_EQ(base64("\xfb\xff"), "+/8=");
}

}  // namespace
}  // namespace ostraka
