// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/run.hpp"

#include <iterator>
#include <mutex>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/evaluation/record_text.hpp"

namespace ostraka {
namespace {

using Trials = std::vector<std::vector<SegmentTrial>>;

void require_same_models(std::span<const EntryIndex* const> indices) {
    const std::vector<Model>& first = indices.front()->library().models;
    for (const EntryIndex* index : indices) {
        const std::vector<Model>& models = index->library().models;
        bool same = models.size() == first.size();
        for (std::size_t m = 0; same && m < first.size(); ++m) {
            same = models[m].name == first[m].name;
        }
        if (!same || index->library().settings.unit != indices.front()->library().settings.unit) {
            throw InvalidInput(
                "libraries can be compared only if they hold the same models in "
                "the same unit");
        }
    }
}

Trials try_segments(std::span<const EntryIndex* const> indices, const TestSet& set,
                    std::size_t scene, const SegmentSettings& settings) {
    Trials trials(indices.size());
    for (const LabeledSegment& segment : segments_of(set.load(scene), scene, settings)) {
        for (std::size_t i = 0; i < indices.size(); ++i) {
            trials[i].push_back(try_segment(*indices[i], segment, settings.ks));
        }
    }
    return trials;
}

}  // namespace

Trials run_segments(std::span<const EntryIndex* const> indices, const TestSet& set,
                    const SegmentSettings& settings, Journal& journal, const Progress& progress) {
    require_same_models(indices);
    std::vector<Trials> of_scene(set.count);
    std::mutex mutex;
    std::size_t done = 0;
    parallel_for(set.count, [&](std::size_t scene) {
        if (const std::optional<std::string> known = journal.find(scene)) {
            of_scene[scene] = segment_trials_from_text(*known);
        } else {
            of_scene[scene] = try_segments(indices, set, scene, settings);
            journal.add(scene, to_text(of_scene[scene]));
        }
        if (of_scene[scene].size() != indices.size()) {
            throw InvalidInput("the journal is of other libraries");
        }
        const std::scoped_lock lock(mutex);
        report(progress, "scenes", ++done, set.count);
    });
    Trials all(indices.size());
    for (Trials& trials : of_scene) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            std::move(trials[i].begin(), trials[i].end(), std::back_inserter(all[i]));
        }
    }
    return all;
}

std::vector<SceneRecord> run_scenes(const Recognizer& recognizer, const ModelLibrary& library,
                                    const TestSet& set, const SceneSettings& settings,
                                    Journal& journal, const Progress& progress) {
    const PoseJudge judge(library, settings.vsd);
    std::vector<SceneRecord> records;
    for (std::size_t i = 0; i < set.count; ++i) {
        if (const std::optional<std::string> known = journal.find(i)) {
            records.push_back(scene_record_from_text(*known, library));
        } else {
            records.push_back(try_scene(recognizer, judge, set.load(i), settings));
            journal.add(i, to_text(records.back()));
        }
        report(progress, "scenes", i + 1, set.count);
    }
    return records;
}

}  // namespace ostraka
