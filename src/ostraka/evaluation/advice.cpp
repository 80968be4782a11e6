// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/evaluation/advice_steps.hpp"
#include "ostraka/evaluation/intervals.hpp"

namespace ostraka {
namespace {

constexpr double kUsualSampling = 0.01;   // of the median diameter: default_sampling()
constexpr double kMostSampling = 0.02;    // of the smallest diameter: 50 points across
constexpr double kSmoothingRadius = 4.0;  // RangeSmoothingSettings::max_radius
constexpr double kHeapDiameters = 2.6;    // width of a heap
constexpr double kNearer = 0.7;           // distances beside the usual one
constexpr double kFarther = 1.4;

// To so many digits.
template <class Round>
double digits(double value, int count, const Round& round) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - count + 1.0);
    // Dividing by a whole number gives the decimal number nearest to it.
    return unit < 1.0 ? round(value / unit) / std::round(1.0 / unit) : unit * round(value / unit);
}
// What is whole but for rounding stays.
double up(double value) {
    return std::ceil(value - 1e-9);
}
double down(double value) {
    return std::floor(value + 1e-9);
}

void require_usable(std::span<const ModelSource> models, const AdviceSettings& settings) {
    if (models.empty()) throw InvalidInput("advice needs at least one part");
    if (settings.scenes < 1 || settings.objects < 1 || settings.segment_scenes < 1) {
        throw InvalidInput("advice needs at least one scene with one object");
    }
    for (const double distance : settings.distances) {
        if (!(distance > 0.0)) throw InvalidInput("distances must be positive");
    }
}

std::vector<double> diameters_of(std::span<const ModelSource> models) {
    std::vector<double> diameters;
    for (const ModelSource& model : models) diameters.push_back(measure(model.mesh).diameter);
    return diameters;
}

void add_warnings(Advice& advice, const AdviceSettings& settings,
                  std::span<const double> diameters) {
    const auto unit = unit_name(settings.library.unit);
    const double smallest = *std::min_element(diameters.begin(), diameters.end());
    if (advice.sampling.conflict()) {
        advice.warnings.push_back(fmt::format(
            "The sensor resolves {:.3g} {}, but the smallest part, {:.4g} {} across, asks for "
            "{:.3g} {}: go nearer, or take a finer sensor.",
            advice.sampling.least, unit, smallest, unit, advice.sampling.most, unit));
    }
    const SensorModel& sensor = settings.sensor.model;
    for (const DistanceAdvice& at : advice.distances) {
        const double distance = at.reach.distance;
        if (distance < sensor.min_depth || distance > sensor.max_depth) {
            advice.warnings.push_back(
                fmt::format("The sensor measures from {:.4g} to {:.4g} {}; {:.4g} {} is outside.",
                            sensor.min_depth, sensor.max_depth, unit, distance, unit));
        }
        if (at.reach.pitch > 1.01 * advice.library.sampling) {
            advice.warnings.push_back(fmt::format(
                "At {:.4g} {} pixels are {:.3g} {} apart, more than the sampling distance of "
                "{:.3g} {}. Where all scans come from there, ask for this distance alone "
                "(--distances): the advice may be another.",
                distance, unit, at.reach.pitch, unit, advice.library.sampling, unit));
        }
    }
}

}  // namespace

SensorReach sensor_reach(const SensorPreset& sensor, double distance) {
    const double step = std::max(sensor.model.ranging.quantization,
                                 sensor.model.inverse_depth_step * distance * distance);
    const double noise = noise_deviation(distance, 1.0, sensor.model);
    // Rounding to steps errs evenly within half a step: its variance is step^2 / 12.
    return {distance, distance / sensor.camera.fx, std::sqrt(noise * noise + step * step / 12.0)};
}

std::vector<double> default_distances(const SensorPreset& sensor,
                                      std::span<const double> diameters) {
    if (diameters.empty()) throw InvalidInput("distances are chosen for at least one part");
    const auto [smallest, largest] = std::minmax_element(diameters.begin(), diameters.end());
    const PinholeCamera& camera = sensor.camera;
    const double lens = std::max(camera.fx / camera.width, camera.fy / camera.height);
    const double near =
        std::max(sensor.model.min_depth + *largest, kHeapDiameters * *largest * lens);
    const double far = std::max(
        near, std::min(sensor.model.max_depth - *largest, kMostSampling * *smallest * camera.fx));
    const double middle = std::clamp(sensor.distance, near, far);
    std::vector<double> distances;
    for (const double wish : {kNearer * middle, middle, kFarther * middle}) {
        double distance = digits(wish, 3, [](double x) { return std::round(x); });
        if (wish <= near) distance = digits(near, 2, up);
        if (wish >= far) distance = digits(far, 2, down);
        if (distances.empty() || distance > 1.05 * distances.back()) distances.push_back(distance);
    }
    return distances;
}

SamplingAdvice advise_sampling(const SensorPreset& sensor, double distance,
                               std::span<const double> diameters) {
    if (diameters.empty())
        throw InvalidInput("a sampling distance is chosen for at least one part");
    const SensorReach reach = sensor_reach(sensor, distance);
    SamplingAdvice advice;
    advice.usual = kUsualSampling * median({diameters.begin(), diameters.end()});
    advice.pitch = reach.pitch;
    // Within a radius of r = 4 s around a point there are pi r^2 / p^2 pixels with noise of their
    // own, a distance p apart. Their mean deviates by d p / (sqrt(pi) r): s is twice that.
    const double apart = reach.pitch * sensor.model.noise_window;
    advice.noise = std::sqrt(2.0 * reach.deviation * apart / (std::sqrt(kPi) * kSmoothingRadius));
    advice.least = std::max(advice.pitch, advice.noise);
    advice.most = kMostSampling * *std::min_element(diameters.begin(), diameters.end());
    advice.sampling = std::max(advice.least, std::min(advice.usual, advice.most));
    return advice;
}

Advice advise(std::span<const ModelSource> models, const AdviceSettings& settings,
              const Progress& progress) {
    require_usable(models, settings);
    const std::vector<double> diameters = diameters_of(models);
    std::vector<double> distances = settings.distances;
    if (distances.empty()) distances = default_distances(settings.sensor, diameters);
    std::sort(distances.begin(), distances.end());
    const double middle = distances[distances.size() / 2];
    Advice advice;
    advice.sampling = advise_sampling(settings.sensor, middle, diameters);
    AdviceSettings complete = settings;
    if (complete.library.sampling == 0.0) complete.library.sampling = advice.sampling.sampling;
    HeapRecords known;
    const ModelLibrary library =
        confirm_library(choose_library(models, complete, middle, advice, progress), complete,
                        middle, advice, known, progress);
    advice.library = library.settings;
    try_heaps(library, complete, distances, std::move(known), advice, progress);
    advice.look_alikes = look_alikes(library, complete, middle, progress);
    add_warnings(advice, complete, diameters);
    return advice;
}

}  // namespace ostraka
