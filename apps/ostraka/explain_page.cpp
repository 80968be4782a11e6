// SPDX-License-Identifier: Apache-2.0
#include "explain_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/recognition/explanation.hpp"
#include "ostraka/recognition/picture.hpp"
#include "ostraka/recognition/verdict_picture.hpp"
#include "ostraka/report/page.hpp"

namespace ostraka::app {
namespace {

struct VerdictName {
    CellVerdict verdict;
    const char* name;
};
constexpr VerdictName kVerdicts[] = {
    {CellVerdict::support, "confirmed"},      {CellVerdict::hidden, "hidden by something"},
    {CellVerdict::violation, "contradicted"}, {CellVerdict::backdrop, "on a larger flat surface"},
    {CellVerdict::missing, "not measured"},   {CellVerdict::unsure, "can't be judged"}};

std::string percent(std::size_t part, std::size_t whole) {
    if (whole == 0) return "0 %";
    return fmt::format("{:.0f} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

std::string counted(std::size_t count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string label_of(const Explanation& one) {
    return one.number == kNoIndex ? one.object.model
                                  : fmt::format("{} #{}", one.object.model, one.number + 1);
}

// Swatches and words, in the reader's scheme.
std::string legend_svg() {
    std::string svg = R"(<svg width="1000" height="26" viewBox="0 0 1000 26" role="img" )"
                      R"(aria-label="Colors of the pictures">)";
    double x = 0.0;
    for (const auto& [verdict, name] : kVerdicts) {
        const Color color = verdict_color(verdict);
        svg += fmt::format(R"(<rect x="{:.0f}" y="5" width="16" height="16" rx="3" )"
                           R"(fill="#{:02x}{:02x}{:02x}"/><text x="{:.0f}" y="18" font-size="14" )"
                           R"(fill="currentColor">{}</text>)",
                           x, color[0], color[1], color[2], x + 23.0, name);
        x += 56.0 + 7.0 * static_cast<double>(std::string_view(name).size());
    }
    return svg + "</svg>";
}

std::string cell_shares(const Verified& v) {
    const std::pair<const char*, std::size_t> parts[] = {
        {"confirmed", v.support},      {"hidden", v.hidden},
        {"contradicted", v.violation}, {"on a larger flat surface", v.backdrop},
        {"not measured", v.missing},   {"can't be judged", v.unsure}};
    std::string words = fmt::format("{} of the silhouette:", counted(v.silhouette, "cell"));
    for (const auto& [name, cells] : parts) {
        if (200 * cells >= v.silhouette && cells > 0)
            words += fmt::format(" {} {},", percent(cells, v.silhouette), name);
    }
    words.pop_back();
    return words + ".";
}

// What the confidence is made of, feature by feature.
PageContent numbers(const Explanation& one, const ConfidenceModel& confidence) {
    Table table{.header = {"feature", "value", "usual", "weight", "effect"}};
    double typical = 0.0;
    for (std::size_t i = 0; i < kFeatures; ++i) {
        const auto feature = static_cast<Feature>(i);
        const double usual = typical_value(feature);
        typical += confidence.weights[i] * usual;
        if (feature == Feature::constant) continue;
        const double value = one.object.features[i];
        table.rows.push_back(
            {{std::string(feature_name(feature)), fmt::format("{:.3f}", value),
              fmt::format("{:.3f}", usual), fmt::format("{:.1f}", confidence.weights[i]),
              fmt::format("{:+.2f}", confidence.weights[i] * (value - usual))}});
    }
    PageContent content;
    content.table(table);
    content.note(
        fmt::format("Effect is weight x (value - usual). The confidence is 1 / (1 + exp(-s)), "
                    "where s is {:.2f}, "
                    "that of the usual values, and the sum of the effects.",
                    typical));
    return content;
}

void add_one(PageContent& page, const Explanation& one, const VerdictPicture& picture,
             const ConfidenceModel& confidence) {
    page.heading(fmt::format("{}: {:.2f}", label_of(one), one.object.confidence), 3);
    page.paragraph(one.verdict);
    page.pictures(std::vector<Picture>{
        {picture.scan,
         fmt::format("The scan there. Proposed by {}, round {}.", one.object.source,
                     one.object.round + 1),
         "the scan around " + label_of(one)},
        {picture.verdicts, cell_shares(one.verified), "verdicts on " + label_of(one)}});
    page.details("Numbers", numbers(one, confidence));
}

void add_facts(PageContent& page, const ExplainedScan& scan, std::size_t near_misses) {
    const Recognition& result = scan.recognition;
    double seconds = 0.0;
    for (const auto& [stage, time] : result.seconds) {
        if (stage != "load" && stage != "read") seconds += time;
    }
    int rounds = 0;
    for (const RecognizedObject& one : result.candidates) rounds = std::max(rounds, one.round + 1);
    page.facts(std::vector<Fact>{
        {std::to_string(result.objects.size()), "reported",
         fmt::format("with a confidence of {:.2f} or more", scan.settings.min_confidence)},
        {std::to_string(result.candidates.size()), "hypotheses verified",
         fmt::format(
             "in {}; {} below", counted(static_cast<std::size_t>(rounds), "round"),
             near_misses == 1 ? "one near miss" : fmt::format("{} near misses", near_misses))},
        {result.table_found ? "yes" : "no", "table found",
         result.table_found ? "nothing is looked for below it" : ""},
        {fmt::format("{:.2f} s", seconds), "search",
         result.out_of_time ? "ended by the time limit" : "without reading the files"}});
}

Image overview(const ExplainedScan& scan) {
    Recognition shown;
    shown.objects = scan.recognition.objects;
    for (std::size_t k = 0; k < shown.objects.size(); ++k) {
        shown.objects[k].model += fmt::format(" #{}", k + 1);
    }
    return draw_recognition(scan.scene, scan.library, shown, {.header = false});
}

void add_confidence(PageContent& page, const ExplainedScan& scan) {
    page.heading("What confidence means");
    page.paragraph(
        "Confidence is the probability that a report is right: of objects reported at 0.9, nine in "
        "ten are right. --min-confidence is the least that is reported: a higher one gives fewer "
        "wrong reports and misses more objects.");
    const auto judged_by = [&](const std::optional<ConfidenceModel>& own) {
        return own && own->weights == scan.recognition.judge.weights;
    };
    page.paragraph(
        judged_by(scan.library.confidence) || judged_by(scan.library.merged_confidence)
            ? "The weights are this library's own, fitted to its models by `ostraka calibrate`."
            : "The weights are the general ones, fitted to other parts. `ostraka calibrate` fits "
              "them to this library's models, and knows which of these are easily mistaken.");
}

void add_time(PageContent& page, const Recognition& result) {
    page.heading("Time");
    Table table{.header = {"stage", "seconds"}};
    for (const auto& [stage, time] : result.seconds) {
        table.rows.push_back({{stage, fmt::format("{:.3f}", time)}});
    }
    page.table(table);
    if (result.out_of_time) {
        page.paragraph("The time limit ended the search: what is best so far is reported.");
    }
}

void add_explanations(PageContent& page, const ExplainedScan& scan,
                      const std::vector<Explanation>& all,
                      const std::vector<VerdictPicture>& pictures) {
    const std::size_t reported = scan.recognition.objects.size();
    for (std::size_t i = 0; i <= all.size(); ++i) {
        if (i == 0) {
            page.heading("Reported objects");
            page.figure(
                legend_svg(),
                "What the scan says of each piece of a placed model, seen from the sensor.");
            if (reported == 0) page.paragraph("There is none.");
        }
        if (i == reported) {
            page.heading("Near misses");
            page.paragraph(
                all.size() == reported
                    ? "There is none."
                    : "The most confident hypotheses that were not reported, the best of each "
                      "model and place.");
        }
        if (i < all.size()) add_one(page, all[i], pictures[i], scan.recognition.judge);
    }
}

}  // namespace

std::string explain_page(const ExplainedScan& scan) {
    PageContent page;
    const Scan prepared = prepare_scan(scan.library, scan.scene, scan.settings);
    const std::vector<Explanation> all =
        explain(scan.library, scan.recognition, prepared, scan.settings,
                {.unit = std::string(unit_name(scan.library.settings.unit))});
    const auto pictures = draw_verdicts(scan.scene, scan.library, prepared, all);
    add_facts(page, scan, all.size() - scan.recognition.objects.size());
    page.picture(overview(scan), "The scan as the sensor saw it, with what was reported.",
                 "the scan with the reported objects");
    add_explanations(page, scan, all, pictures);
    add_confidence(page, scan);
    add_time(page, scan.recognition);
    return html_page({.title = "What is in " + scan.scene_name,
                      .subtitle = fmt::format("Recognized with {}, {}.", scan.library_name,
                                              counted(scan.library.models.size(), "model")),
                      .footer = "ostraka " OSTRAKA_VERSION},
                     page);
}

}  // namespace ostraka::app
