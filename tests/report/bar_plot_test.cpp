// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/bar_plot.hpp"

#include <limits>

#include "ostraka/base/error.hpp"
#include "report/xml_elements.hpp"

namespace ostraka {
namespace {

using namespace report_testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Bars of a series; legend entries are 12 pixels a side.
std::vector<Element> bars(const std::vector<Element>& elements, const std::string& paint) {
    std::vector<Element> found;
    for (const Element& e : with_class(elements, "f-" + paint)) {
        const bool mark = e.tag == "rect" && e.number("width") == 12 && e.number("height") == 12;
        if (e.tag == "rect" && !mark) found.push_back(e);
    }
    return found;
}

BarPlot simple() {
    BarPlot plot;
    plot.groups = {"one", "two"};
    plot.series = {{"a", {0.5, 1.0}, {}, {}}, {"b", {0.25, kNan}, {0.2, 0.1}, {0.3, 0.2}}};
    plot.y_range = std::pair(0.0, 1.0);
    plot.percent = true;
    return plot;
}

TEST(BarPlot, HeightsAreInProportion) {
    const BarPlot plot = simple();
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    const std::vector<Element> a = bars(elements, "s0");
    const std::vector<Element> b = bars(elements, "s1");
    ASSERT_EQ(a.size(), 2U);
    ASSERT_EQ(b.size(), 1U);  // what isn't a number has no bar
    EXPECT_NEAR(a[0].number("height"), 0.5 * plot.size.height, 0.02);
    EXPECT_NEAR(a[1].number("height"), 1.0 * plot.size.height, 0.02);
    EXPECT_NEAR(b[0].number("height"), 0.25 * plot.size.height, 0.02);
    EXPECT_NEAR(a[0].number("y") + a[0].number("height"), a[1].number("y") + a[1].number("height"),
                0.02);
    EXPECT_GE(b[0].number("x"), a[0].number("x") + a[0].number("width"));
    EXPECT_TRUE(says(elements, "50"));
    EXPECT_TRUE(says(elements, "two, a: 100.0 %"));
    EXPECT_TRUE(says(elements, "one, b: 25.0 % (20.0 % to 30.0 %)"));
    EXPECT_EQ(with_class(elements, "s-ink").size(), 1U);  // one whisker
}

TEST(BarPlot, NegativeValuesHangFromZero) {
    BarPlot plot;
    plot.groups = {"up", "down"};
    plot.series = {{"", {10.0, -5.0}, {}, {}}};
    const std::vector<Element> found = bars(parse_xml(draw_svg(plot)), "s0");
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[0].number("y") + found[0].number("height"), found[1].number("y"), 0.02);
}

TEST(BarPlot, AReferenceIsALineAtItsValue) {
    BarPlot plot = simple();
    plot.references = {{"published", 0.75, {}}, {"limit", 0.5, 1}, {"nothing", kNan, {}}};
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_TRUE(says(elements, "published"));
    EXPECT_FALSE(says(elements, "nothing"));
    const Element bar = bars(elements, "s0")[1];  // from 0 to 1
    std::size_t lines = 0;
    for (const Element& e : elements) {
        if (e.tag != "line" || !e.attributes.contains("stroke-dasharray")) continue;
        if (e.number("x2") - e.number("x1") < 100.0) continue;  // in the legend
        const double value = e.has_class("s-s1") ? 0.5 : 0.75;
        EXPECT_NEAR(e.number("y1"), bar.number("y") + (1.0 - value) * plot.size.height, 0.02);
        ++lines;
    }
    EXPECT_EQ(lines, 2U);
}

TEST(BarPlot, LongNamesOfManyGroupsAreTurned) {
    BarPlot plot;
    plot.series = {{"", {}, {}, {}}};
    for (int g = 0; g < 60; ++g) {
        plot.groups.push_back("a_model_with_a_long_name_" + std::to_string(g));
        plot.series[0].values.push_back(g);
    }
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_EQ(bars(elements, "s0").size(), 60U);  // one of them of height 0
    std::size_t turned = 0;
    for (const Element& e : elements) turned += e.attributes.contains("transform") ? 1 : 0;
    EXPECT_EQ(turned, 60U);
    EXPECT_TRUE(says(elements, "a_model_with_a_long_name_59"));  // whole, as a hint
}

TEST(BarPlot, WithoutDataItSaysSo) {
    EXPECT_TRUE(says(parse_xml(draw_svg(BarPlot{})), "no data"));
    BarPlot plot;
    plot.groups = {"<script>"};
    EXPECT_TRUE(says(parse_xml(draw_svg(plot)), "no data"));
    plot.series = {{"a", {kNan}, {}, {}}};
    EXPECT_TRUE(says(parse_xml(draw_svg(plot)), "no data"));
    plot.series = {{"a", {0.0}, {kNan}, {kNan}}};
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_TRUE(says(elements, "<script>"));
}

TEST(BarPlot, RejectsArraysThatDoNotFit) {
    BarPlot plot = simple();
    plot.series[0].values.pop_back();
    EXPECT_THROW(draw_svg(plot), InvalidInput);
    plot = simple();
    plot.series[1].low.clear();
    EXPECT_THROW(draw_svg(plot), InvalidInput);
}

}  // namespace
}  // namespace ostraka
