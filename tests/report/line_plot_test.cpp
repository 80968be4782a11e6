// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/line_plot.hpp"

#include <cstdio>
#include <limits>

#include "ostraka/base/error.hpp"
#include "report/xml_elements.hpp"

namespace ostraka {
namespace {

using namespace report_testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a circle of marker_path() stands: "Mx-r y a r ...".
std::pair<double, double> center(const Element& circle) {
    double left = 0.0;
    double y = 0.0;
    double radius = 0.0;
    const std::string path = circle.attributes.at("d");
    EXPECT_EQ(std::sscanf(path.c_str(), "M%lf %lfa%lf", &left, &y, &radius), 3) << path;
    return {left + radius, y};
}

std::vector<Element> markers(const std::vector<Element>& elements, const std::string& paint) {
    std::vector<Element> found;
    for (const Element& element : with_class(elements, "f-" + paint)) {
        if (element.tag == "path" && element.has_class("s-paper")) found.push_back(element);
    }
    return found;
}

double tick_y(const std::vector<Element>& elements, const std::string& label) {
    const Element text = with_text(elements, "text", label);
    return text.number("y") - 0.35 * text.number("font-size");
}

TEST(LinePlot, AValueStandsWhereItsTickDoes) {
    LinePlot plot;
    plot.series = {{"", {0.0, 4.0, 10.0}, {0.0, 0.5, 1.0}, {}, {}}};
    plot.y_range = std::pair(0.0, 1.0);
    plot.percent_y = true;
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    const std::vector<Element> dots = markers(elements, "s0");
    ASSERT_EQ(dots.size(), 3U);
    EXPECT_NEAR(center(dots[0]).second, tick_y(elements, "0 %"), 0.02);
    EXPECT_NEAR(center(dots[2]).second, tick_y(elements, "100 %"), 0.02);
    EXPECT_NEAR(center(dots[1]).second, 0.5 * (center(dots[0]).second + center(dots[2]).second),
                0.02);
    EXPECT_NEAR(center(dots[2]).second - center(dots[0]).second, -plot.size.height, 0.02);
    EXPECT_NEAR(center(dots[1]).first, with_text(elements, "text", "4").number("x"), 0.02);
    EXPECT_NEAR(center(dots[0]).first, with_text(elements, "text", "0").number("x"), 0.02);
}

TEST(LinePlot, IsTheSameEachTimeAndShowsItsLabels) {
    LinePlot plot;
    plot.title = "Recall <b>";
    plot.x_label = "visible share";
    plot.y_label = "recall & more";
    plot.series = {{"a", {1, 2}, {3, 4}, {2, 3}, {4, 5}}, {"<script>", {1, 2}, {4, 3}, {}, {}}};
    const std::string svg = draw_svg(plot);
    EXPECT_EQ(svg, draw_svg(plot));
    EXPECT_EQ(svg.find("<script>"), std::string::npos);
    const std::vector<Element> elements = parse_xml(svg);
    for (const char* text : {"Recall <b>", "visible share", "recall & more", "a", "<script>"}) {
        EXPECT_TRUE(says(elements, text)) << text;
    }
    EXPECT_EQ(elements[0].attributes.at("aria-label"), "Recall <b>");
}

TEST(LinePlot, WhatIsNotFiniteLeavesAGap) {
    LinePlot plot;
    plot.series = {{"", {0, 1, 2, 3, 4, 5, kNan}, {1, 2, kNan, 2, 1, kInfinity, 1}, {}, {}}};
    const std::string svg = draw_svg(plot);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    const std::vector<Element> elements = parse_xml(svg);
    EXPECT_EQ(markers(elements, "s0").size(), 4U);
    for (const Element& path : with_class(elements, "s-s0")) {
        const std::string& data = path.attributes.at("d");
        EXPECT_EQ(std::count(data.begin(), data.end(), 'M'), 2) << data;
        EXPECT_EQ(std::count(data.begin(), data.end(), 'L'), 2) << data;
    }
}

TEST(LinePlot, WithoutDataItSaysSo) {
    LinePlot plot;
    plot.title = "Empty";
    EXPECT_TRUE(says(parse_xml(draw_svg(plot)), "no data"));
    plot.series = {{"a", {}, {}, {}, {}}, {"b", {kNan}, {1.0}, {}, {}}};
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_TRUE(says(elements, "no data"));
    EXPECT_TRUE(says(elements, "Empty"));
}

TEST(LinePlot, FewIntervalsAreWhiskersManyABand) {
    LinePlot plot;
    for (const std::size_t count : {5U, 30U}) {
        PlotSeries series;
        for (std::size_t i = 0; i < count; ++i) {
            series.x.push_back(double(i));
            series.y.push_back(1.0);
            series.low.push_back(0.5);
            series.high.push_back(i == 3 ? kNan : 2.0);
        }
        plot.series = {series};
        const std::vector<Element> elements = parse_xml(draw_svg(plot));
        std::size_t bands = 0;
        for (const Element& e : elements) bands += e.attributes.contains("fill-opacity") ? 1 : 0;
        EXPECT_EQ(bands, count > 12 ? 1U : 0U);
        EXPECT_EQ(with_class(elements, "s-s0").size(), count > 12 ? 1U : 2U);
    }
}

TEST(LinePlot, PointsOutsideOfAGivenRangeAreNotShown) {
    LinePlot plot;
    plot.series = {{"", {0, 1, 2}, {0.5, 1e9, 0.5}, {}, {}}};
    plot.y_range = std::pair(0.0, 1.0);
    EXPECT_EQ(markers(parse_xml(draw_svg(plot)), "s0").size(), 2U);
}

TEST(LinePlot, TheDiagonalCrossesASquare) {
    LinePlot plot;
    plot.diagonal = true;
    plot.percent_x = plot.percent_y = true;
    plot.series = {{"method", {0.1, 0.9}, {0.05, 0.8}, {}, {}}};
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    std::vector<Element> dashed;
    for (const Element& e : elements) {
        if (e.tag == "line" && e.parent == "svg" && e.attributes.contains("stroke-dasharray")) {
            dashed.push_back(e);
        }
    }
    ASSERT_EQ(dashed.size(), 1U);
    const double across = dashed[0].number("x2") - dashed[0].number("x1");
    EXPECT_NEAR(across, dashed[0].number("y1") - dashed[0].number("y2"), 0.02);
    EXPECT_GT(across, 150.0);
}

TEST(LinePlot, TheLegendNeverCoversData) {
    for (const std::size_t count : {2U, 20U}) {
        LinePlot plot;
        for (std::size_t s = 0; s < count; ++s) {
            plot.series.push_back(
                {"a method with quite a long name " + std::to_string(s), {0, 1}, {0, 1}, {}, {}});
        }
        const std::vector<Element> elements = parse_xml(draw_svg(plot));
        const std::vector<Element> nested = with_tag(elements, "svg");
        ASSERT_EQ(nested.size(), 2U);
        const double right = nested[1].number("x") + nested[1].number("width");
        const double bottom = nested[1].number("y") + nested[1].number("height");
        std::size_t entries = 0;
        for (const Element& e : with_tag(elements, "text")) {
            if (!e.text.starts_with("a method")) continue;
            ++entries;
            EXPECT_TRUE(e.number("x") > right || e.number("y") > bottom + 10.0) << e.text;
            EXPECT_LT(e.number("y"), elements[0].number("height"));
            EXPECT_LT(e.number("x"), elements[0].number("width"));
        }
        EXPECT_EQ(entries, count);
    }
}

TEST(LinePlot, RejectsArraysThatDoNotFit) {
    LinePlot plot;
    plot.series = {{"", {1, 2}, {1}, {}, {}}};
    EXPECT_THROW(draw_svg(plot), InvalidInput);
    plot.series = {{"", {1, 2}, {1, 2}, {0, 1}, {}}};
    EXPECT_THROW(draw_svg(plot), InvalidInput);
    plot.series = {{"", {1, 2}, {1, 2}, {}, {}}};
    plot.size.width = 10;
    EXPECT_THROW(draw_svg(plot), InvalidInput);
}

}  // namespace
}  // namespace ostraka
