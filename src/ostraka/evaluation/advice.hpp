// SPDX-License-Identifier: Apache-2.0
// How well will these parts be recognized by this sensor from this distance? Worked out before
// anything is bought or built: a library is made, scans are simulated, and the whole pipeline runs.
// docs/advise.md tells the method and its limits.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/progress.hpp"
#include "ostraka/evaluation/intervals.hpp"
#include "ostraka/evaluation/scenes.hpp"
#include "ostraka/io/png_file.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/views/sensor_presets.hpp"

namespace ostraka {

struct AdviceSettings {
    SensorPreset sensor;            ///< lengths in library.unit
    std::vector<double> distances;  ///< sensor to the middle of the heap, ascending, each positive;
                                    ///< empty: default_distances()
    int scenes = 12;                ///< heaps a distance
    int objects = 8;                ///< dropped in each heap
    int segment_scenes = 24;        ///< scenes of protocol S, on which settings are compared
    int viewpoints = 20;            ///< around each part, for what looks alike: as ViewSettings
    bool compare = true;      ///< try several settings; else the library is made as `library` says
    bool pictures = true;     ///< draw examples and pairs of parts that look alike
    LibrarySettings library;  ///< sampling 0: as advise_sampling() says; budget and descriptors:
                              ///< what is not compared
    MatchSettings match{.min_visible = 0.1};
    std::uint64_t seed = 0;
};

/// What a sensor gives of a surface that faces it, in the preset's unit.
struct SensorReach {
    double distance = 0.0;
    double pitch = 0.0;      ///< between neighboring pixels' points
    double deviation = 0.0;  ///< of one depth: noise and rounding together
};
SensorReach sensor_reach(const SensorPreset& sensor, double distance);

/// Three distances (fewer if they coincide): 0.7, 1 and 1.4 times the usual one, where the sensor
/// measures, a heap fits into the image, and the smallest part is 50 pixels across.
/// @param diameters  of the parts, the sensor's unit; at least 1.
std::vector<double> default_distances(const SensorPreset& sensor,
                                      std::span<const double> diameters);

/// A sampling distance by rule: 1 % of the median diameter, but not below `least`, what the sensor
/// resolves, nor above `most`, what the smallest part needs. Where these conflict, `least`.
struct SamplingAdvice {
    double usual = 0.0;  ///< 1 % of the median diameter
    double pitch = 0.0;  ///< of the pixels: finer is interpolation
    double noise = 0.0;  ///< where a sampling distance is 2 deviations of the smoothed depth
    double least = 0.0;  ///< max(pitch, noise)
    double most = 0.0;   ///< 2 % of the smallest diameter
    double sampling = 0.0;
    bool conflict() const { return least > most; }
};
SamplingAdvice advise_sampling(const SensorPreset& sensor, double distance,
                               std::span<const double> diameters);

/// One way to make the library, and what protocol S says of it.
struct SettingsTrial {
    double sampling = 0.0;
    int budget = 0;
    std::vector<std::string> descriptors;
    std::size_t entries = 0;
    std::uint64_t bytes = 0;                ///< of the library's file
    double build_seconds = 0.0;             ///< -1: not built by itself
    std::map<std::string, Interval> rates;  ///< by method; "fused" is what recognition uses
    const Interval& fused() const { return rates.at("fused"); }
};

/// The smallest library whose fused rate is within the interval of the best. @param trials  at
/// least 1. @return its index; ties: the earlier one.
std::size_t cheapest_good(std::span<const SettingsTrial> trials);

/// The smallest good library against the usual one (first sampling distance, budget 48, all
/// descriptors) in the same heaps at the middle distance. Segments are few and not the whole job.
struct Confirmation {
    bool made = false;  ///< false: there was nothing to compare
    Interval small;     ///< recall with the smallest good library
    Interval usual;     ///< recall with the usual one
    Interval loss;      ///< usual - small, on the same objects
    bool kept = true;   ///< the small one is recommended: it loses less than kMostLoss
};
inline constexpr double kMostLoss = 0.03;

/// All parts at one distance.
struct DistanceAdvice {
    SensorReach reach;
    SceneSummary summary;
    Image example;  ///< a scan with what was found in it; empty without pictures
    std::string example_text;
};

enum class Outlook { good, mixed, bad };

struct PartAdvice {
    std::string name;
    double diameter = 0.0;
    std::vector<double> pixels;                   ///< across its diameter, at each distance
    std::vector<RecallBin> by_distance;           ///< low = high = the distance
    std::vector<RecallBin> by_hidden;             ///< all distances, hidden share in quarters
    std::vector<std::vector<RecallBin>> by_both;  ///< at each distance, hidden share in quarters
    std::size_t wrong = 0;                        ///< reports of it where there is none
    Outlook outlook = Outlook::mixed;
    std::string verdict;  ///< a sentence without its subject
};

/// The verdict on a part from its figures. @param names  of all parts.
/// @param taken_for  how often each part was reported in its place, by index; itself is ignored.
void judge_part(PartAdvice& part, Unit unit, std::span<const std::string> names,
                std::span<const double> taken_for);

/// What a part seen alone, from one side, by the sensor, is most like.
struct LookAlike {
    std::uint32_t part = 0;
    std::uint32_t other = kNoIndex;  ///< the other part with the nearest entry; kNoIndex: no other
    int viewpoint = 0;               ///< where the two are hardest to tell apart
    double margin = 0.0;  ///< distance of the other's nearest entry / own nearest entry, there;
                          ///< below 1: taken for the other
    std::size_t confused = 0;  ///< viewpoints from which an entry of another part is nearest
    std::size_t viewpoints = 0;
    Image picture;  ///< both as seen from there; empty without pictures
};

struct Advice {
    std::vector<PartAdvice> parts;                 ///< in the order of their names
    std::vector<DistanceAdvice> distances;         ///< ascending
    SamplingAdvice sampling;                       ///< at the middle distance
    std::vector<SettingsTrial> trials;             ///< samplings and budgets; at least 1
    std::size_t chosen = 0;                        ///< of trials
    std::vector<SettingsTrial> descriptor_trials;  ///< of the chosen one: all, then each alone
    std::size_t chosen_descriptors = 0;            ///< of descriptor_trials
    Confirmation confirmation;
    std::size_t segments = 0;            ///< that the trials rest on
    LibrarySettings library;             ///< recommended: all below rests on it
    std::vector<double> confusion;       ///< as confusion_matrix(), all distances
    std::vector<LookAlike> look_alikes;  ///< one a part
    std::vector<std::string> warnings;   ///< a sentence each
};

/// @param models  distinct names; meshes in settings.library.unit.
/// @return the same for any number of threads, but for seconds.
/// @throws InvalidInput for no models or settings out of range; Interrupted.
Advice advise(std::span<const ModelSource> models, const AdviceSettings& settings,
              const Progress& progress = {});

}  // namespace ostraka
