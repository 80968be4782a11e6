// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/page.hpp"

#include "ostraka/base/error.hpp"
#include "ostraka/report/line_plot.hpp"
#include "ostraka/report/markup.hpp"
#include "report/xml_elements.hpp"

namespace ostraka {
namespace {

using namespace report_testing;

const Image kImage = {2, 1, {{255, 0, 0}, {1, 2, 3}}};
constexpr const char* kHostile = "<script>alert('x')</script>\"&\xff";
constexpr const char* kShown = "<script>alert('x')</script>\"&\xEF\xBF\xBD";

std::string svg() {
    LinePlot plot;
    plot.series = {{"a", {0, 1}, {0, 1}, {}, {}}};
    return draw_svg(plot);
}

PageContent everything(const std::string& text) {
    PageContent page;
    page.heading(text);
    page.heading(text, 3);
    page.paragraph(text);
    page.note(text);
    page.list(std::vector<std::string>{text, text});
    page.facts(std::vector<Fact>{{text, text, text}, {"98.9 %", "recall", ""}});
    page.table({{text, text}, {{{text, text}, RowStatus::kGood, true}, {{text}}}, text});
    page.figure(svg(), text);
    page.figures(std::vector<Figure>{{svg(), text}, {svg(), ""}});
    page.picture(kImage, text, text);
    page.pictures(std::vector<Picture>{{kImage, text, text}, {kImage, "", "alt"}});
    PageContent inner;
    inner.heading(text);
    inner.paragraph(text);
    page.details(text, inner, true);
    page.preformatted(text);
    return page;
}

TEST(Page, IsWellFormedAndEscapesAllText) {
    const std::string html = html_page({kHostile, kHostile, kHostile, true}, everything(kHostile));
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_TRUE(html.starts_with("<!DOCTYPE html>\n"));
    const std::vector<Element> elements = parse_xml(html);
    for (const char* tag : {"title", "h1", "h2", "h3", "p", "li", "dt", "dd", "caption", "th", "td",
                            "figcaption", "summary", "pre", "footer"}) {
        EXPECT_EQ(with_text(elements, tag, kShown).tag, tag);
    }
    EXPECT_EQ(with_tag(elements, "img")[0].attributes.at("alt"), kShown);
    EXPECT_EQ(html, html_page({kHostile, kHostile, kHostile, true}, everything(kHostile)));
}

TEST(Page, LoadsAndRunsNothing) {
    const std::string html = html_page({"t", "s", "f", true}, everything("x"));
    const std::vector<Element> elements = parse_xml(html);
    for (const Element& e : elements) {
        EXPECT_NE(e.tag, "script");
        EXPECT_NE(e.tag, "link");
        for (const auto& [name, value] : e.attributes) {
            EXPECT_FALSE(name.starts_with("on")) << name;
            EXPECT_TRUE(name != "src" || value.starts_with("data:image/png;base64,")) << value;
            EXPECT_TRUE(name != "href" || value.starts_with("#")) << value;
        }
    }
    for (const char* text : {"url(", "@import", "https:"}) {
        EXPECT_EQ(html.find(text), std::string::npos) << text;
    }
    EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST(Page, PicturesAreInThePage) {
    PageContent page;
    page.picture(kImage, "", "two pixels");
    const std::vector<Element> found = with_tag(parse_xml(page.html()), "img");
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].attributes.at("src"), "data:image/png;base64," + base64(encode_png(kImage)));
    EXPECT_EQ(found[0].number("width"), 2.0);
    EXPECT_THROW(page.picture({}, "", ""), InvalidInput);
}

TEST(Page, RowsOfPicturesAreFilledEvenly) {
    for (const auto& [count, columns] : {std::pair(1, 1), {3, 3}, {4, 4}, {5, 3}, {6, 3}, {9, 3}}) {
        PageContent page;
        page.pictures(std::vector<Picture>(static_cast<std::size_t>(count), {kImage, "", ""}));
        EXPECT_NE(page.html().find("--columns:" + std::to_string(columns)), std::string::npos);
    }
}

TEST(Page, SectionsAreLinked) {
    PageContent page;
    page.heading("First");
    page.heading("Detail", 3);
    page.heading("Second");
    PageContent inner;
    inner.heading("Hidden");
    page.details("more", inner);
    page.heading("Third");
    EXPECT_EQ(page.sections(), std::vector<std::string>({"First", "Second", "Third"}));
    const std::vector<Element> elements = parse_xml(html_page({"t"}, page));
    for (const auto& [name, id] : {std::pair("First", "s1"), {"Second", "s2"}, {"Third", "s3"}}) {
        EXPECT_EQ(with_text(elements, "h2", name).attributes.at("id"), id);
        EXPECT_EQ(with_text(elements, "a", name).attributes.at("href"), "#" + std::string(id));
    }
    EXPECT_FALSE(with_text(elements, "h2", "Hidden").attributes.contains("id"));
    EXPECT_TRUE(
        with_tag(parse_xml(html_page({.title = "t", .contents = false}, page)), "nav").empty());
}

TEST(Page, TablesTellNumbersFromTextAndGoodFromBad) {
    PageContent page;
    page.table({.header = {"model", "why", "recall"},
                .rows = {{{"cam", "small", "97.0 %"}, RowStatus::kBad}, {{"hook"}}},
                .text_columns = 2});
    const std::vector<Element> elements = parse_xml(page.html());
    EXPECT_TRUE(with_tag(elements, "tr")[1].has_class("bad"));
    EXPECT_TRUE(with_text(elements, "td", "small").has_class("text"));
    EXPECT_FALSE(with_text(elements, "td", "97.0 %").has_class("text"));
    EXPECT_EQ(with_tag(elements, "td").size(), 4U);  // the short row is filled up
    EXPECT_THROW(page.table({.header = {"a"}, .rows = {{{"1", "2"}}}}), InvalidInput);
    PageContent empty;
    empty.table({.header = {"a", "b"}});
    EXPECT_TRUE(says(parse_xml(empty.html()), "no data"));
}

TEST(Page, LinesAreNotBrokenBeforeAPercentSign) {
    PageContent page;
    page.paragraph("95 % of 40 % and the % sign");
    page.preformatted("95 %");
    EXPECT_EQ(page.html(), "<p>95\xC2\xA0% of 40\xC2\xA0% and the % sign</p>\n<pre>95 %</pre>\n");
}

TEST(Page, NothingIsWrittenForNothing) {
    PageContent page;
    page.facts({});
    page.list({});
    page.figures({});
    page.pictures({});
    page.table({});
    EXPECT_EQ(page.html(), "");
    parse_xml(html_page({}, page));
    EXPECT_THROW(page.heading("x", 1), InvalidInput);
    EXPECT_THROW(page.heading("x", 5), InvalidInput);
}

}  // namespace
}  // namespace ostraka
