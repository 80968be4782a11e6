// SPDX-License-Identifier: Apache-2.0
// The figures of protocols O and P, worked out from records.
#include <algorithm>
#include <cmath>

#include "ostraka/evaluation/scenes.hpp"

namespace ostraka {
namespace {

// Recall by a number that each true object has.
template <class Of>
std::vector<RecallBin> recall_by(std::span<const SceneRecord> records, const ModelLibrary& library,
                                 const MatchSettings& settings, int bins, const Of& of) {
    std::vector<RecallBin> result;
    std::vector<Matching> matchings;
    for (const SceneRecord& record : records) {
        matchings.push_back(match(record, library, settings));
    }
    for (int b = 0; b < bins; ++b) {
        RecallBin bin{static_cast<double>(b) / bins, static_cast<double>(b + 1) / bins};
        const auto inside = [&](double value) {
            return value >= bin.low && (value < bin.high || (b + 1 == bins && value <= 1.0));
        };
        std::vector<double> hits(records.size(), 0.0);
        std::vector<double> objects(records.size(), 0.0);
        for (std::size_t s = 0; s < records.size(); ++s) {
            for (const PosePair& hit : matchings[s].hits) {
                if (!inside(of(records[s], hit.truth))) continue;
                hits[s] += 1.0;
                objects[s] += 1.0;
            }
            for (const std::uint32_t miss : matchings[s].misses) {
                if (inside(of(records[s], miss))) objects[s] += 1.0;
            }
            bin.objects += static_cast<std::size_t>(objects[s]);
        }
        bin.recall = bootstrap_ratio(hits, objects);
        result.push_back(bin);
    }
    return result;
}

// BOP's thresholds: 0.05 to 0.5 of the diameter or of 1; for MSPD 5 to 50 pixels.
constexpr int kThresholds = 10;
double threshold(int number) {
    return 0.05 * (number + 1);
}

// Targets of a scene that are found if the error is below a limit.
template <class Error>
std::size_t found_targets(const SceneRecord& record, const Error& error, double limit) {
    std::map<std::uint32_t, std::size_t> instances;  // how many reports of a model are judged
    for (const TrueObject& object : record.truth) {
        if (object.visible_fraction >= 0.1) ++instances[object.model];
    }
    std::vector<bool> truth_used(record.truth.size(), false);
    std::size_t found = 0;
    for (std::uint32_t r = 0; r < record.reports.size(); ++r) {
        auto left = instances.find(record.reports[r].model_index);
        if (left == instances.end() || left->second == 0) continue;
        --left->second;
        const PosePair* best = nullptr;
        for (const PosePair& pair : record.pairs) {
            if (pair.report != r || truth_used[pair.truth] || !(error(pair) < limit)) continue;
            if (best == nullptr || error(pair) < error(*best)) best = &pair;
        }
        if (best == nullptr) continue;
        truth_used[best->truth] = true;
        if (record.truth[best->truth].visible_fraction >= 0.1) ++found;
    }
    return found;
}

}  // namespace

SceneSummary summarize(std::span<const SceneRecord> records, const ModelLibrary& library,
                       const MatchSettings& settings) {
    SceneSummary summary;
    std::vector<double> hits;
    std::vector<double> objects;
    std::vector<double> reports;
    std::vector<double> adis;
    std::vector<double> degrees;
    for (const SceneRecord& record : records) {
        const Matching matching = match(record, library, settings);
        summary.hits += matching.hits.size();
        summary.objects += matching.hits.size() + matching.misses.size();
        summary.wrong += matching.wrong.size();
        hits.push_back(static_cast<double>(matching.hits.size()));
        objects.push_back(static_cast<double>(matching.hits.size() + matching.misses.size()));
        reports.push_back(static_cast<double>(matching.hits.size() + matching.wrong.size()));
        for (const PosePair& hit : matching.hits) {
            adis.push_back(hit.adi);
            degrees.push_back(hit.degrees);
        }
        const auto all = record.seconds.find("all");
        if (all != record.seconds.end()) {
            summary.seconds += all->second / static_cast<double>(records.size());
        }
    }
    summary.recall = bootstrap_ratio(hits, objects);
    summary.precision =
        summary.hits + summary.wrong > 0 ? bootstrap_ratio(hits, reports) : Interval{1.0, 1.0, 1.0};
    summary.median_adi = bootstrap_median(adis);
    summary.median_degrees = median(degrees);
    return summary;
}

std::vector<RecallBin> recall_by_occlusion(std::span<const SceneRecord> records,
                                           const ModelLibrary& library,
                                           const MatchSettings& settings, int bins) {
    return recall_by(records, library, settings, bins,
                     [](const SceneRecord& record, std::uint32_t truth) {
                         return 1.0 - record.truth[truth].visible_fraction;
                     });
}

std::vector<RecallBin> recall_by_clutter(std::span<const SceneRecord> records,
                                         const ModelLibrary& library, const MatchSettings& settings,
                                         int bins) {
    return recall_by(
        records, library, settings, bins,
        [](const SceneRecord& record, std::uint32_t truth) { return record.clutter[truth]; });
}

std::vector<ReliabilityBin> reliability(std::span<const SceneRecord> records,
                                        const ModelLibrary& library, MatchSettings settings,
                                        int bins) {
    settings.min_confidence = 0.0;
    struct Counts {
        double confidence = 0.0;
        std::vector<double> right;
        std::vector<double> reports;
    };
    std::vector<Counts> counts(static_cast<std::size_t>(bins));
    for (Counts& count : counts) {
        count.right.assign(records.size(), 0.0);
        count.reports.assign(records.size(), 0.0);
    }
    for (std::size_t s = 0; s < records.size(); ++s) {
        const Matching matching = match(records[s], library, settings);
        const auto add = [&](std::uint32_t report, bool right) {
            const double confidence = records[s].reports[report].confidence;
            const int bin = std::clamp(static_cast<int>(confidence * bins), 0, bins - 1);
            Counts& count = counts[static_cast<std::size_t>(bin)];
            count.confidence += confidence;
            count.reports[s] += 1.0;
            if (right) count.right[s] += 1.0;
        };
        for (const PosePair& hit : matching.hits) add(hit.report, true);
        for (const std::uint32_t wrong : matching.wrong) add(wrong, false);
    }
    std::vector<ReliabilityBin> result;
    for (const Counts& count : counts) {
        double reports = 0.0;
        for (const double value : count.reports) reports += value;
        if (reports == 0.0) continue;
        result.push_back({count.confidence / reports, static_cast<std::size_t>(reports),
                          bootstrap_ratio(count.right, count.reports)});
    }
    return result;
}

std::vector<double> confusion_matrix(std::span<const SceneRecord> records,
                                     const ModelLibrary& library, const MatchSettings& settings) {
    const std::size_t models = library.models.size();
    std::vector<double> counts(models * (models + 1), 0.0);
    for (const SceneRecord& record : records) {
        const Matching matching = match(record, library, settings);
        for (const PosePair& hit : matching.hits) {
            const std::size_t model = record.truth[hit.truth].model;
            counts[model * (models + 1) + model] += 1.0;
        }
        for (std::size_t i = 0; i < matching.misses.size(); ++i) {
            const std::size_t model = record.truth[matching.misses[i]].model;
            const std::uint32_t report = matching.instead[i];
            const std::size_t answer =
                report == kNoIndex ? models : record.reports[report].model_index;
            // The right model in a wrong pose is no recognition: it counts as none.
            counts[model * (models + 1) + (answer == model ? models : answer)] += 1.0;
        }
    }
    return counts;
}

AverageRecalls average_recalls(std::span<const SceneRecord> records) {
    AverageRecalls recalls;
    double targets = 0.0;
    for (const SceneRecord& record : records) {
        for (const TrueObject& object : record.truth) {
            if (object.visible_fraction >= 0.1) targets += 1.0;
        }
        if (record.image_width > 0) recalls.has_images = true;
        for (const PosePair& pair : record.pairs) {
            if (!pair.vsd.empty()) recalls.has_vsd = true;
        }
    }
    if (targets == 0.0) return recalls;
    for (const SceneRecord& record : records) {
        const double pixels = record.image_width / 640.0;
        for (int i = 0; i < kThresholds; ++i) {
            const auto count = [&](const auto& error, double limit) {
                return static_cast<double>(found_targets(record, error, limit));
            };
            recalls.mssd += count([](const PosePair& p) { return p.mssd; }, threshold(i));
            if (recalls.has_images) {
                recalls.mspd +=
                    count([](const PosePair& p) { return p.mspd; }, 100.0 * threshold(i) * pixels);
            }
            for (std::size_t tau = 0; recalls.has_vsd && tau < kThresholds; ++tau) {
                const auto error = [&](const PosePair& p) {
                    return p.vsd.size() > tau ? p.vsd[tau] : 1.0;
                };
                recalls.vsd += count(error, threshold(i));
            }
        }
    }
    // Whole numbers up to here: finding everything gives exactly 1.
    recalls.mssd /= targets * kThresholds;
    recalls.mspd /= targets * kThresholds;
    recalls.vsd /= targets * kThresholds * kThresholds;
    return recalls;
}

}  // namespace ostraka
