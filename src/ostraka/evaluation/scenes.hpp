// SPDX-License-Identifier: Apache-2.0
// Protocols O and P: the whole pipeline on whole scans, told nothing about what is there (method,
// section 5). A record holds what was seen and reported; every figure is worked out from records.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ostraka/evaluation/intervals.hpp"
#include "ostraka/evaluation/pose_errors.hpp"
#include "ostraka/evaluation/test_scenes.hpp"
#include "ostraka/recognition/recognize.hpp"

namespace ostraka {

/// A report against a true object of the same model that is less than a diameter away.
struct PosePair {
    std::uint32_t report = 0;  ///< index into SceneRecord::reports
    std::uint32_t truth = 0;   ///< index into SceneRecord::truth
    double adi = 0.0;          ///< model diameters
    double mssd = 0.0;         ///< model diameters
    double mspd = -1.0;        ///< pixels; -1: the scan has no camera
    double degrees = 0.0;      ///< rotation, least over symmetries
    std::vector<double> vsd;  ///< for each tolerance of VsdSettings; empty: no camera, or not asked
};

/// What was in a scene, and what was reported.
struct SceneRecord {
    std::string name;
    int scene = 0;  ///< as in TestScene
    int image = 0;  ///< as in TestScene
    std::vector<TrueObject> truth;
    std::vector<double> clutter;  ///< per true object: share of the scan's points that aren't its
    std::vector<RecognizedObject> reports;  ///< most confident first
    std::vector<PosePair> pairs;
    std::map<std::string, double> seconds;  ///< of each stage
    int image_width = 0;                    ///< pixels; 0: the scan has no camera
};

struct SceneSettings {
    RecognitionSettings recognition;  ///< min_confidence: keep it low, figures have their own
    bool vsd = false;                 ///< also render for VSD, which takes time
    double vsd_delta = 15.0;          ///< mm; tolerance of VSD's visibility
};

/// Models made ready for pose errors, once for many scenes.
class PoseJudge {
  public:
    /// @param library  must outlive it. @param vsd  prepare for VSD, too.
    PoseJudge(const ModelLibrary& library, bool vsd);
    /// Errors of every report against every true object nearby.
    std::vector<PosePair> judge(const TestScene& scene, std::span<const RecognizedObject> reports,
                                const SceneSettings& settings) const;

  private:
    const ModelLibrary* library_;
    std::vector<std::vector<Pose>> symmetries_;  // per model
    std::vector<RayModel> rays_;                 // per model, for VSD
};

/// Recognizes a scene and judges the answer.
SceneRecord try_scene(const Recognizer& recognizer, const PoseJudge& judge, const TestScene& scene,
                      const SceneSettings& settings);

/// The same of given reports.
SceneRecord record_of(const PoseJudge& judge, const TestScene& scene,
                      std::vector<RecognizedObject> reports, const SceneSettings& settings);

/// What counts as found.
struct MatchSettings {
    double max_adi = 0.10;      ///< in model diameters
    double min_visible = 0.15;  ///< true objects less visible are ignored: neither hit nor miss
    double min_confidence = RecognitionSettings{}.min_confidence;  ///< others are ignored
};

struct Matching {
    std::vector<PosePair> hits;         ///< of true objects that count
    std::vector<std::uint32_t> misses;  ///< true objects that count, without a hit
    std::vector<std::uint32_t> wrong;  ///< reports that match no true object, ignored ones included
    std::vector<std::uint32_t> instead;  ///< per miss: the wrong report in its place, or kNoIndex
};

/// Pairs reports with true objects, each at most once, smallest ADI first.
Matching match(const SceneRecord& record, const ModelLibrary& library,
               const MatchSettings& settings = {});

struct SceneSummary {
    std::size_t objects = 0;  ///< hits and misses
    std::size_t hits = 0;
    std::size_t wrong = 0;
    Interval recall;      ///< hits / objects
    Interval precision;   ///< hits / (hits + wrong); 1 if there is neither
    Interval median_adi;  ///< of hits, in model diameters
    double median_degrees = 0.0;
    double seconds = 0.0;  ///< mean of a scene
};
SceneSummary summarize(std::span<const SceneRecord> records, const ModelLibrary& library,
                       const MatchSettings& settings = {});

/// Hits and objects in a range of something, for curves.
struct RecallBin {
    double low = 0.0;
    double high = 0.0;
    std::size_t objects = 0;
    Interval recall;
};
/// Recall by the share that is hidden, 1 - visible fraction.
std::vector<RecallBin> recall_by_occlusion(std::span<const SceneRecord> records,
                                           const ModelLibrary& library,
                                           const MatchSettings& settings, int bins = 10);
/// Recall by clutter.
std::vector<RecallBin> recall_by_clutter(std::span<const SceneRecord> records,
                                         const ModelLibrary& library, const MatchSettings& settings,
                                         int bins = 10);

/// Reports with a confidence within a range, and how many of them are right.
struct ReliabilityBin {
    double confidence = 0.0;  ///< mean
    std::size_t reports = 0;
    Interval right;
};
std::vector<ReliabilityBin> reliability(std::span<const SceneRecord> records,
                                        const ModelLibrary& library, MatchSettings settings,
                                        int bins = 10);

/// matrix[true model * (models + 1) + model reported in its place]; the last column: none.
std::vector<double> confusion_matrix(std::span<const SceneRecord> records,
                                     const ModelLibrary& library, const MatchSettings& settings);

/// BOP's average recalls of the localization task: the number of instances of each model is known,
/// and as many of its most confident reports are judged. Objects less than 0.1 visible don't count.
struct AverageRecalls {
    double mssd = 0.0;
    double mspd = 0.0;  ///< thresholds in pixels of an image 640 wide
    double vsd = 0.0;
    bool has_images = false;  ///< mspd is known
    bool has_vsd = false;
    double all() const { return (mssd + mspd + vsd) / 3.0; }
};
AverageRecalls average_recalls(std::span<const SceneRecord> records);

}  // namespace ostraka
