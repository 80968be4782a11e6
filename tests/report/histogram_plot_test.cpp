// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/histogram_plot.hpp"

#include <limits>

#include "ostraka/base/error.hpp"
#include "report/xml_elements.hpp"

namespace ostraka {
namespace {

using namespace report_testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(HistogramPlot, CountsEachValueOnce) {
    HistogramPlot plot;
    plot.values = {0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.3, 0.3, 0.95, 1.0, kNan};
    plot.bins = 10;
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_TRUE(says(elements, "0.0 to 0.1: 2"));
    EXPECT_TRUE(says(elements, "0.1 to 0.2: 2"));
    EXPECT_TRUE(says(elements, "0.2 to 0.3: 1"));
    EXPECT_TRUE(says(elements, "0.3 to 0.4: 3"));
    EXPECT_TRUE(says(elements, "0.9 to 1.0: 2"));  // the last bin holds its upper end
    double sum = 0.0;
    double highest = 0.0;
    for (const Element& e : with_class(elements, "f-s0")) {
        if (e.tag != "rect") continue;
        sum += e.number("height");
        highest = std::max(highest, e.number("height"));
    }
    EXPECT_NEAR(sum / highest, 10.0 / 3.0, 0.01);
}

TEST(HistogramPlot, SaysHowManyLieOutside) {
    HistogramPlot plot;
    plot.values = {1, 2, 3, 100, 200, -5};
    plot.x_label = "error, mm";
    plot.x_range = std::pair(0.0, 10.0);
    plot.references = {{"median", 2.5, {}}};
    const std::vector<Element> elements = parse_xml(draw_svg(plot));
    EXPECT_TRUE(says(elements, "error, mm (3 outside of the range shown)"));
    EXPECT_TRUE(says(elements, "median"));
}

TEST(HistogramPlot, EqualValuesAndNoneAreDrawn) {
    HistogramPlot plot;
    EXPECT_TRUE(says(parse_xml(draw_svg(plot)), "no data"));
    plot.values = {kNan};
    EXPECT_TRUE(says(parse_xml(draw_svg(plot)), "no data"));
    plot.values.assign(1000, 0.0);
    parse_xml(draw_svg(plot));
    plot.values.assign(1000, 7.0);
    parse_xml(draw_svg(plot));
    plot.values = {1e99, -1e99, 0.0};
    parse_xml(draw_svg(plot));
    plot.bins = -1;
    EXPECT_THROW(draw_svg(plot), InvalidInput);
}

}  // namespace
}  // namespace ostraka
