// SPDX-License-Identifier: Apache-2.0
// The search for objects in one scan. It goes in rounds: what is found explains a part of the scan,
// and in what is left other objects, or more of the same, come to the fore.
#pragma once

#include <span>

#include "ostraka/base/stopwatch.hpp"
#include "ostraka/library/retrieval.hpp"
#include "ostraka/recognition/confidence.hpp"
#include "ostraka/recognition/recognize.hpp"

namespace ostraka {

/// A hypothesis that was verified, and what its confidence comes from.
struct Judged {
    Verified verified;
    Features features{};
    int round = 0;  ///< in which it came up
};

/// What remains of a hypothesis' confidence beside what else was verified.
struct Standing {
    Features features{};
    double confidence = 0.0;
    std::uint32_t rival_model = kNoIndex;  ///< the likeliest that explains the same
};

class SceneSearch {
  public:
    /// @param scan  prepared with the same settings. All but it must outlive the search.
    SceneSearch(const EntryIndex& index, std::span<const ModelProbe> probes, Scan scan,
                const RecognitionSettings& settings, const Stopwatch& since_start);

    void run();

    /// All that was verified.
    const std::vector<Judged>& judged() const { return judged_; }
    /// The best explanation of the scan: numbers of what was judged, most confident first.
    /// @param min_confidence  of each, its rivals considered.
    std::vector<std::size_t> explanation(double min_confidence) const;
    /// @param number  of what was judged.
    Standing standing(std::size_t number) const;
    /// What confidence comes from.
    const ConfidenceModel& confidence_model() const { return confidence_model_; }
    /// Wall time of each stage.
    const std::map<std::string, double>& seconds() const { return seconds_; }
    bool out_of_time() const { return out_of_time_; }

  private:
    void propose_by_keypoints();
    void propose_by_faces();
    void propose_by_segments();
    bool play_round(int number);
    std::vector<Hypothesis> refined();
    Judged judge(const Hypothesis& hypothesis, int round) const;
    void try_turns();
    Judged best_turn(const Judged& found) const;
    void verify_new(const std::vector<Hypothesis>& finalists, int round);
    std::size_t mark_explained();
    std::size_t unexplained() const;
    bool late() const;
    bool expired();
    std::vector<const Verified*> verified() const;
    bool asked_for(std::size_t model) const;

    const EntryIndex& index_;
    std::span<const ModelProbe> probes_;
    Scan scan_;
    const RecognitionSettings& settings_;
    const Stopwatch& since_start_;
    ConfidenceModel confidence_model_;
    std::vector<std::vector<Hypothesis>> proposed_;  // per model
    std::vector<Judged> judged_;
    std::map<std::string, double> seconds_;
    bool out_of_time_ = false;
};

}  // namespace ostraka
