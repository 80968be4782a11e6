// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/refinement.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/registration/icp.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kCoarsePoints = 300;
constexpr std::size_t kFinePoints = 2000;
constexpr double kCoarseReach = 10.0;  // sampling distances
constexpr double kFineReach = 2.5;     // sampling distances
constexpr double kPlace = 0.25;        // diameters between centers that are at the same place
constexpr std::size_t kPerPlace = 5;
constexpr double kStrict = 0.4;             // cosine between the normals of a pair, at least
constexpr double kLenient = 0.0;            // the same, far from the truth
constexpr double kEndReach = 1.0;           // sampling distances
constexpr std::size_t kGlanceSamples = 96;  // of the model's surface, for a first look at a pose
constexpr std::size_t kGlanceShare = 8;     // candidates looked at again, for each one refined

// Scores and sorts, best first.
void score_all(const Scan& scan, const ModelProbe& probe, std::vector<Hypothesis>& hypotheses,
               double tolerance, std::size_t samples = kProbeSamples) {
    parallel_for(
        hypotheses.size(),
        [&](std::size_t i) {
            hypotheses[i].score = quick_score(
                gather_evidence(scan, probe, hypotheses[i].T_scene_model, tolerance, samples));
        },
        16);
    std::stable_sort(hypotheses.begin(), hypotheses.end(),
                     [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; });
}

// The best `count` hypotheses, each farther than `distance` from every better one, and at most
// kPerPlace with their centers at about the same place: the many poses of a symmetric part must not
// crowd out its other instances.
void thin_out(std::vector<Hypothesis>& hypotheses, std::size_t count, const MeshShape& shape,
              double distance) {
    std::vector<Hypothesis> kept;
    for (const Hypothesis& hypothesis : hypotheses) {
        if (kept.size() == count) break;
        const Vec3d center = hypothesis.T_scene_model * shape.center;
        std::size_t same_place = 0;
        bool twin = false;
        for (const Hypothesis& better : kept) {
            twin = twin ||
                   nearly_equal(hypothesis.T_scene_model, better.T_scene_model, shape, distance);
            const double apart = (center - better.T_scene_model * shape.center).norm();
            if (apart < kPlace * shape.diameter) ++same_place;
        }
        if (!twin && same_place < kPerPlace) kept.push_back(hypothesis);
    }
    hypotheses = std::move(kept);
}

// The scan around a placed model, thinned out evenly.
struct Sample {
    std::vector<Vec3f> points;
    std::vector<Vec3f> normals;
};

Sample points_around(const Scan& scan, const MeshShape& shape, const Pose& T_scene_model,
                     double reach, std::size_t most) {
    const Vec3f center = Vec3d(T_scene_model * shape.center).cast<float>();
    std::vector<std::size_t> around;
    scan.blocks.for_each_within(scan.cloud.points, center, static_cast<float>(shape.radius + reach),
                                [&](std::size_t i) {
                                    if (scan.explained.empty() || !scan.explained[i]) {
                                        around.push_back(i);
                                    }
                                });
    const std::size_t stride = 1 + around.size() / most;
    Sample sample;
    for (std::size_t i = 0; i < around.size(); i += stride) {
        sample.points.push_back(scan.cloud.points[around[i]]);
        sample.normals.push_back(scan.cloud.normals[around[i]]);
    }
    return sample;
}

Pose registered(const Sample& sample, const ModelProbe& probe, const Pose& T_scene_model,
                double start, double end, double min_cosine) {
    const IcpSettings settings{
        .start_distance = start, .end_distance = end, .min_cosine = min_cosine};
    return icp(probe.field(), sample.points, sample.normals, T_scene_model.inverse(), settings)
        .T_target_source.inverse();
}

}  // namespace

bool nearly_equal(const Pose& a, const Pose& b, const MeshShape& shape, double distance) {
    const Vec3d centers = a * shape.center - b * shape.center;
    if (centers.norm() >= distance) return false;
    const Mat3d turn = a.linear() * b.linear().transpose();
    const double angle = std::acos(std::clamp((turn.trace() - 1.0) / 2.0, -1.0, 1.0));
    return centers.norm() + angle * shape.radius < distance;
}

Pose refine_pose(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                 std::size_t max_points, double reach) {
    const Sample sample =
        points_around(scan, probe.model().shape, T_scene_model, reach, max_points);
    return registered(sample, probe, T_scene_model, reach, kEndReach * scan.sampling, kStrict);
}

Pose refine_finely(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model) {
    return refine_pose(scan, probe, T_scene_model, kFinePoints, kFineReach * scan.sampling);
}

Pose refine_from_afar(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                      double tolerance) {
    const double reach = kCoarseReach * scan.sampling;
    const double end = kEndReach * scan.sampling;
    const Sample sample =
        points_around(scan, probe.model().shape, T_scene_model, reach, kCoarsePoints);
    const Pose T_strict = registered(sample, probe, T_scene_model, reach, end, kStrict);
    // Curved surfaces guide a pose back from as far without.
    if (probe.faces().empty()) return T_strict;
    Pose T_lenient = registered(sample, probe, T_scene_model, reach, 0.4 * reach, kLenient);
    T_lenient = registered(sample, probe, T_lenient, 0.5 * reach, end, kStrict);
    const auto score = [&](const Pose& T) {
        return quick_score(gather_evidence(scan, probe, T, tolerance));
    };
    return score(T_lenient) > score(T_strict) ? T_lenient : T_strict;
}

std::vector<Hypothesis> refine_hypotheses(const Scan& scan, const ModelProbe& probe,
                                          std::vector<Hypothesis> hypotheses,
                                          const RecognitionSettings& settings) {
    const MeshShape& shape = probe.model().shape;
    const double tolerance = settings.tolerance * scan.sampling;
    score_all(scan, probe, hypotheses, 2.0 * tolerance, kGlanceSamples);
    const auto candidates = static_cast<std::size_t>(settings.candidates_per_model);
    if (hypotheses.size() > kGlanceShare * candidates) hypotheses.resize(kGlanceShare * candidates);
    score_all(scan, probe, hypotheses, 2.0 * tolerance);
    thin_out(hypotheses, candidates, shape, 3.0 * scan.sampling);
    parallel_for(hypotheses.size(), [&](std::size_t i) {
        hypotheses[i].T_scene_model =
            refine_from_afar(scan, probe, hypotheses[i].T_scene_model, tolerance);
    });
    score_all(scan, probe, hypotheses, tolerance);
    thin_out(hypotheses, static_cast<std::size_t>(settings.finalists_per_model), shape,
             2.0 * scan.sampling);
    parallel_for(hypotheses.size(), [&](std::size_t i) {
        hypotheses[i].T_scene_model = refine_finely(scan, probe, hypotheses[i].T_scene_model);
    });
    score_all(scan, probe, hypotheses, tolerance);
    thin_out(hypotheses, hypotheses.size(), shape, scan.sampling);
    return hypotheses;
}

}  // namespace ostraka
