// SPDX-License-Identifier: Apache-2.0
// What is found in heaps, at each distance: protocol O.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/evaluation/advice_steps.hpp"
#include "ostraka/evaluation/run.hpp"
#include "ostraka/recognition/picture.hpp"

namespace ostraka {
namespace {

constexpr int kQuarters = 4;
constexpr int kPictureWidth = 640;
constexpr double kReliable = 0.85;   // recall
constexpr std::size_t kEnough = 4;   // objects that a bin needs to be judged
constexpr double kMuchWorse = 0.15;  // a distance whose recall is so much less is left out
constexpr double kFewPixels = 60.0;  // across a part
constexpr double kDense = 0.35;      // side of the square the objects fall in, by their number
constexpr int kPlaces = 3;      // tried for each object: few make a heap, in which much is hidden
constexpr double kTable = 5.0;  // its side, in mean diameters

// The records with only one part's objects counting: others are as if hidden.
std::vector<SceneRecord> records_of_part(std::span<const SceneRecord> records, std::uint32_t part) {
    std::vector<SceneRecord> own(records.begin(), records.end());
    for (SceneRecord& record : own) {
        for (TrueObject& object : record.truth) {
            if (object.model != part) object.visible_fraction = 0.0;
        }
    }
    return own;
}

// A heap's records at all distances as one, because intervals draw heaps.
void append(SceneRecord& heap, const SceneRecord& record) {
    const auto reports = static_cast<std::uint32_t>(heap.reports.size());
    const auto truths = static_cast<std::uint32_t>(heap.truth.size());
    heap.truth.insert(heap.truth.end(), record.truth.begin(), record.truth.end());
    heap.reports.insert(heap.reports.end(), record.reports.begin(), record.reports.end());
    for (PosePair pair : record.pairs) {
        pair.report += reports;
        pair.truth += truths;
        heap.pairs.push_back(pair);
    }
}

// The scene whose recall is most like that of all.
std::size_t typical_scene(std::span<const SceneRecord> records, const ModelLibrary& library,
                          const AdviceSettings& settings, double recall) {
    std::size_t typical = 0;
    double least = 2.0;
    for (std::size_t s = 0; s < records.size(); ++s) {
        const double off = std::abs(
            summarize(records.subspan(s, 1), library, settings.match).recall.value - recall);
        if (off >= least) continue;
        least = off;
        typical = s;
    }
    return typical;
}

void draw_example(DistanceAdvice& at, std::span<const SceneRecord> records, const TestSet& set,
                  const ModelLibrary& library, const AdviceSettings& settings) {
    const std::size_t scene = typical_scene(records, library, settings, at.summary.recall.value);
    Recognition shown;
    for (const RecognizedObject& report : records[scene].reports) {
        if (report.confidence >= settings.match.min_confidence) shown.objects.push_back(report);
    }
    at.example = draw_recognition(set.load(scene).cloud, library, shown,
                                  {.width = kPictureWidth, .header = false});
    const Matching matching = match(records[scene], library, settings.match);
    at.example_text = fmt::format("{} of {} found", matching.hits.size(),
                                  matching.hits.size() + matching.misses.size());
    if (!matching.wrong.empty()) {
        at.example_text += fmt::format(", {} reported wrongly", matching.wrong.size());
    }
}

void add_part(PartAdvice& part, std::uint32_t number,
              const std::vector<std::vector<SceneRecord>>& by_distance, const ModelLibrary& library,
              const AdviceSettings& settings, Advice& advice) {
    std::vector<SceneRecord> heaps(by_distance.front().size());
    for (std::size_t d = 0; d < by_distance.size(); ++d) {
        const SensorReach& reach = advice.distances[d].reach;
        const std::vector<SceneRecord> own = records_of_part(by_distance[d], number);
        const SceneSummary summary = summarize(own, library, settings.match);
        part.pixels.push_back(part.diameter / reach.pitch);
        part.by_distance.push_back(
            {reach.distance, reach.distance, summary.objects, summary.recall});
        part.by_both.push_back(recall_by_occlusion(own, library, settings.match, kQuarters));
        for (const SceneRecord& record : by_distance[d]) {
            for (const std::uint32_t w : match(record, library, settings.match).wrong) {
                part.wrong += record.reports[w].model_index == number ? 1U : 0U;
            }
        }
        for (std::size_t s = 0; s < own.size(); ++s) append(heaps[s], own[s]);
    }
    part.by_hidden = recall_by_occlusion(heaps, library, settings.match, kQuarters);
}

struct Count {
    double hits = 0.0;
    double objects = 0.0;
    double rate() const { return objects > 0.0 ? hits / objects : 0.0; }
    void add(const RecallBin& bin) {
        hits += bin.recall.value * static_cast<double>(bin.objects);
        objects += static_cast<double>(bin.objects);
    }
};

std::string how_well(double overall, int quarters) {
    if (quarters == kQuarters) return "found reliably, even with more than 75 % hidden";
    if (quarters > 0) return fmt::format("found reliably to {} % hidden", 25 * quarters);
    if (overall >= kReliable) return fmt::format("found mostly ({:.0f} %)", 100.0 * overall);
    if (overall >= 0.6) return fmt::format("found more often than not ({:.0f} %)", 100.0 * overall);
    if (overall >= 0.2) return fmt::format("found at times only ({:.0f} %)", 100.0 * overall);
    return "hardly ever found";
}

// How many quarters of hidden share, from the first, hold enough objects that are nearly all found.
int reliable_quarters(std::span<const Count> hidden) {
    int quarters = 0;
    for (const Count& count : hidden) {
        if (count.objects < kEnough || count.rate() < kReliable) break;
        ++quarters;
    }
    return quarters;
}

}  // namespace

TestSet heaps_at(const ModelLibrary& library, const AdviceSettings& settings, double distance) {
    DropScenes recipe{.objects = settings.objects,
                      .min_elevation = 0.5,
                      .max_elevation = 1.3,
                      .distance = distance / mean_diameter(library),
                      .table_size = kTable,
                      .camera = settings.sensor.camera,
                      .sensor = settings.sensor.model,
                      .seed = settings.seed};
    recipe.drop.area = kDense * std::sqrt(static_cast<double>(settings.objects));
    recipe.drop.positions = kPlaces;
    recipe.sensor.ranging.seed = recipe.seed;
    return simulated_set(library, recipe, static_cast<std::size_t>(settings.scenes));
}

std::vector<SceneRecord> recognize_heaps(const ModelLibrary& library,
                                         const AdviceSettings& settings, double distance,
                                         const std::string& stage, const Progress& progress) {
    const Recognizer recognizer(library);
    Journal journal("", "");
    return run_scenes(recognizer, library, heaps_at(library, settings, distance), {}, journal,
                      [&](std::string_view, std::size_t done, std::size_t total) {
                          return !progress || progress(stage, done, total);
                      });
}

void judge_part(PartAdvice& part, Unit unit, std::span<const std::string> names,
                std::span<const double> taken_for) {
    double best = 0.0;
    for (const RecallBin& bin : part.by_distance) best = std::max(best, bin.recall.value);
    Count all;
    std::vector<Count> hidden(kQuarters);
    std::string where;
    std::string elsewhere;
    for (std::size_t d = 0; d < part.by_distance.size(); ++d) {
        const RecallBin& bin = part.by_distance[d];
        if (bin.objects == 0) continue;
        // Few objects prove nothing: even the interval must lie below the best.
        if (bin.recall.value < best - kMuchWorse && bin.recall.high < best) {
            elsewhere += fmt::format("; at {:.4g} {} only {:.0f} %", bin.low, unit_name(unit),
                                     100.0 * bin.recall.value);
            continue;
        }
        where += fmt::format("{}{:.4g}", where.empty() ? "" : ", ", bin.low);
        all.add(bin);
        for (std::size_t q = 0; q < hidden.size(); ++q) hidden[q].add(part.by_both[d][q]);
    }
    if (all.objects == 0.0) {
        part.outlook = Outlook::mixed;
        part.verdict = "never visible enough to be judged: more scenes are needed";
        return;
    }
    const int quarters = reliable_quarters(hidden);
    const double overall = all.rate();
    part.outlook = overall < 0.5                     ? Outlook::bad
                   : quarters >= 2 || overall >= 0.9 ? Outlook::good
                                                     : Outlook::mixed;
    if (part.outlook == Outlook::good && !elsewhere.empty()) part.outlook = Outlook::mixed;
    part.verdict = fmt::format("{}, at {} {}{}", how_well(overall, quarters), where,
                               unit_name(unit), elsewhere);
    const auto rival = std::max_element(taken_for.begin(), taken_for.end());
    if (rival != taken_for.end() && *rival >= 2.0) {
        part.verdict +=
            fmt::format("; taken for {} {:.0f} times",
                        names[static_cast<std::size_t>(rival - taken_for.begin())], *rival);
    }
    if (part.outlook != Outlook::good && part.pixels.back() < kFewPixels) {
        part.verdict += fmt::format("; only {:.0f} pixels across at {:.4g} {}", part.pixels.back(),
                                    part.by_distance.back().low, unit_name(unit));
    }
}

void try_heaps(const ModelLibrary& library, const AdviceSettings& settings,
               std::span<const double> distances, HeapRecords known, Advice& advice,
               const Progress& progress) {
    std::vector<std::vector<SceneRecord>> by_distance;
    std::vector<SceneRecord> all;
    for (const double distance : distances) {
        if (!known.contains(distance)) {
            known[distance] = recognize_heaps(
                library, settings, distance,
                fmt::format("{:.4g} {}", distance, unit_name(settings.library.unit)), progress);
        }
        by_distance.push_back(std::move(known[distance]));
        DistanceAdvice at{.reach = sensor_reach(settings.sensor, distance)};
        at.summary = summarize(by_distance.back(), library, settings.match);
        if (settings.pictures) {
            draw_example(at, by_distance.back(), heaps_at(library, settings, distance), library,
                         settings);
        }
        advice.distances.push_back(std::move(at));
        all.insert(all.end(), by_distance.back().begin(), by_distance.back().end());
    }
    advice.confusion = confusion_matrix(all, library, settings.match);
    const std::size_t count = library.models.size();
    std::vector<std::string> names;
    for (const Model& model : library.models) names.push_back(model.name);
    for (std::uint32_t m = 0; m < count; ++m) {
        const Model& model = library.models[m];
        PartAdvice part{.name = model.name, .diameter = model.shape.diameter};
        add_part(part, m, by_distance, library, settings, advice);
        std::vector<double> taken(
            advice.confusion.begin() + std::ptrdiff_t(m * (count + 1)),
            advice.confusion.begin() + std::ptrdiff_t(m * (count + 1) + count));
        taken[m] = 0.0;
        judge_part(part, settings.library.unit, names, taken);
        advice.parts.push_back(std::move(part));
    }
}

}  // namespace ostraka
