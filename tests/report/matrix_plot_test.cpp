// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/matrix_plot.hpp"

#include <limits>

#include "ostraka/base/error.hpp"
#include "report/xml_elements.hpp"

namespace ostraka {
namespace {

using namespace report_testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Element> cells(const std::vector<Element>& elements) {
    return with_tag(elements, "rect");
}

TEST(MatrixPlot, AgreementAndConfusionDifferInColor) {
    MatrixPlot plot;
    plot.title = "Confusion";
    plot.row_label = "true model";
    plot.column_label = "answer";
    plot.rows = {"cam", "hook"};
    plot.columns = {"cam", "hook", "(none)"};
    plot.values = {8, 2, 0, 0, 5, 5};
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    const std::vector<Element> shaded = cells(elements);
    ASSERT_EQ(shaded.size(), 4U);  // zeros have no shade
    EXPECT_TRUE(shaded[0].has_class("f-s0"));
    EXPECT_TRUE(shaded[1].has_class("f-s1"));
    EXPECT_TRUE(shaded[2].has_class("f-s0"));
    EXPECT_TRUE(shaded[3].has_class("f-s1"));
    EXPECT_NEAR(shaded[0].number("fill-opacity"), 0.1 + 0.9 * 0.8, 0.006);
    EXPECT_NEAR(shaded[2].number("fill-opacity"), 0.1 + 0.9 * 0.5, 0.006);
    EXPECT_TRUE(says(elements, "8"));
    EXPECT_TRUE(says(elements, "0"));
    EXPECT_TRUE(says(elements, "cam \xE2\x86\x92 hook: 2"));
    EXPECT_LT(shaded[0].number("x"), shaded[1].number("x"));
    EXPECT_EQ(shaded[0].number("y"), shaded[1].number("y"));
    EXPECT_LT(shaded[1].number("y"), shaded[2].number("y"));
    EXPECT_EQ(shaded[1].number("x"), shaded[2].number("x"));
}

TEST(MatrixPlot, NumbersStandOutFromTheirCells) {
    MatrixPlot plot;
    plot.rows = plot.columns = {"a", "b"};
    plot.values = {1.0, 0.0, 0.1, 0.9};
    plot.counts = false;
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    // White on full blue on a light page; dark on the brighter blue of a dark page.
    const Element full = with_text(elements, "text", "100");
    EXPECT_TRUE(full.has_class("f-inverse"));
    EXPECT_TRUE(full.has_class("tl"));
    EXPECT_TRUE(full.has_class("td"));
    const Element pale = with_text(elements, "text", "10");
    EXPECT_TRUE(pale.has_class("f-ink"));
    EXPECT_FALSE(pale.has_class("td"));
}

TEST(MatrixPlot, SixtyModelsFitAPage) {
    MatrixPlot plot;
    for (int i = 0; i < 60; ++i) plot.rows.push_back("model_with_a_long_name_" + std::to_string(i));
    plot.columns = plot.rows;
    plot.columns.emplace_back("(unknown)");
    for (std::size_t i = 0; i < 60 * 61; ++i) plot.values.push_back(i % 61 == i / 61 ? 120.0 : 0.0);
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_LE(elements[0].number("width"), 1120.0);
    EXPECT_EQ(cells(elements).size(), 60U);
    std::size_t numbers = 0;
    for (const Element& e : with_tag(elements, "text")) {
        if (e.text != "120") continue;
        ++numbers;
        EXPECT_GE(e.number("font-size"), 5.0);
    }
    EXPECT_EQ(numbers, 60U);
    EXPECT_FALSE(says(elements, "0"));
}

TEST(MatrixPlot, HostileNamesAndEmptyCellsDoNoHarm) {
    MatrixPlot plot;
    EXPECT_TRUE(says(parse_xml(draw_svg(plot)), "no data"));
    plot.rows = {"<script>alert(1)</script>", "\"><img src=x>"};
    plot.columns = {"\xff\xfe", "&amp;"};
    plot.values = {kNan, -3.0, 1e12, 0.0};
    const std::string svg = draw_svg(plot);
    EXPECT_EQ(svg.find("<script"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    const std::vector<Element> elements = parse_xml(svg);
    EXPECT_TRUE(says(elements, "&amp;"));
    plot.values.pop_back();
    EXPECT_THROW(draw_svg(plot), InvalidInput);
}

}  // namespace
}  // namespace ostraka
