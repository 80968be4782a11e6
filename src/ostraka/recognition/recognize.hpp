// SPDX-License-Identifier: Apache-2.0
// The main job: which objects of the library are in a scan, and where (method, section 3).
#pragma once

#include <map>
#include <memory>
#include <string>

#include "ostraka/library/confidence_model.hpp"
#include "ostraka/library/model_library.hpp"
#include "ostraka/recognition/settings.hpp"

namespace ostraka {

struct Scan;  // scan.hpp

struct RecognizedObject {
    std::string model;
    std::uint32_t model_index = kNoIndex;  ///< into ModelLibrary::models
    Pose T_scene_model =
        Pose::Identity();     ///< model points to scene points, both in the library's unit
    double confidence = 0.0;  ///< 0 to 1
    double visible_fraction =
        0.0;  ///< share of its silhouette, seen from the sensor, that the scan shows
    double inlier_rms = 0.0;  ///< distance between model and scan where they agree, library unit
    std::string source;       ///< what proposed it: "segment" or "keypoints"
    int round = 0;            ///< of the search in which it came up, from 0
    Features features{};      ///< what the confidence comes from
    std::string rival;  ///< the other model that likeliest explains the same (Feature::rival says
                        ///< with what odds); empty: none does
};

struct Recognition {
    std::vector<RecognizedObject> objects;     ///< most confident first
    std::vector<RecognizedObject> candidates;  ///< with RecognitionSettings::keep_candidates: all
                                               ///< that was verified, reported or not
    std::vector<std::uint32_t> lost_to;        ///< for each candidate the reported object that
                                               ///< explains the same of the scan, as an index into
                                               ///< `objects`; of a reported one itself; kNoIndex
                                               ///< if there is none
    ConfidenceModel judge;                     ///< that the confidences come from
    std::map<std::string, double> seconds;     ///< wall time of each stage
    std::size_t scan_points = 0;               ///< at the library's sampling distance
    bool table_found = false;
    bool out_of_time = false;  ///< RecognitionSettings::time_limit ended the search
};

/// A library made ready for many scans. recognize() is const and safe from many threads.
/// The library must outlive it.
class Recognizer {
  public:
    explicit Recognizer(const ModelLibrary& library);
    ~Recognizer();
    Recognizer(Recognizer&&) noexcept;
    Recognizer& operator=(Recognizer&&) noexcept;

    /// @param scene  a scan in the library's unit; NaN points are "no return"; the sensor is at
    ///               scene.viewpoint.
    /// @throws InvalidInput if the scan has no usable points, or its size makes its unit
    /// implausible.
    Recognition recognize(const PointCloud& scene, const RecognitionSettings& settings = {}) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// The scan as recognize() prepares it: what its hypotheses are verified against.
/// @param scene  as given to recognize(). @throws InvalidInput as recognize() does.
Scan prepare_scan(const ModelLibrary& library, const PointCloud& scene,
                  const RecognitionSettings& settings);

/// One scan, once.
Recognition recognize(const ModelLibrary& library, const PointCloud& scene,
                      const RecognitionSettings& settings = {});

}  // namespace ostraka
