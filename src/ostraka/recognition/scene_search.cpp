// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/scene_search.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/choice.hpp"
#include "ostraka/recognition/face_matching.hpp"
#include "ostraka/recognition/keypoint_matching.hpp"
#include "ostraka/recognition/refinement.hpp"
#include "ostraka/recognition/segment_matching.hpp"

namespace ostraka {
namespace {

constexpr int kMaxRounds = 8;
constexpr double kAccept = 0.5;        // confidence from which an object explains its points
constexpr std::size_t kMinLeft = 100;  // unexplained points that are worth another round
constexpr double kOnSurface = 1.5;     // sampling distances from an object that explains a point
constexpr double kFaceSlack = 3.0;     // sampling distances that a face may seem to be longer
constexpr std::size_t kMostByFaces = 4000;  // poses of each model
constexpr std::size_t kTurnPoints = 800;    // by which each turn is registered
constexpr double kTurnReach = 2.5;          // sampling distances, and of the diameter at least:
constexpr double kTurnShare = 0.045;        // half a step of the turns, at its far end
constexpr std::size_t kTurnsRefined = 3;    // of those that map a model nearly onto itself
constexpr double kTwin = 0.5;               // sampling distances between poses that are the same

void mark_points(const Verified& object, const ModelProbe& probe, Scan& scan) {
    const Pose T_model_scene = object.hypothesis.T_scene_model.inverse(Eigen::Isometry);
    const Mat3f R = T_model_scene.linear().cast<float>();
    const Vec3f t = T_model_scene.translation().cast<float>();
    const auto limit = static_cast<float>(kOnSurface * scan.sampling);
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
        if (scan.explained[i]) continue;
        const Vec3f at = R * scan.cloud.points[i] + t;
        const std::uint32_t nearest = probe.field().nearest(at);
        if (nearest == kNoIndex) continue;
        const float off = probe.field().normal(nearest).dot(at - probe.field().point(nearest));
        const bool beside =
            (at - probe.field().point(nearest)).squaredNorm() > 4.0F * limit * limit;
        scan.explained[i] = !beside && std::abs(off) < limit;
    }
}

const ConfidenceModel& model_of(const ModelLibrary& library, const Scan& scan) {
    if (scan.merged) {
        return library.merged_confidence ? *library.merged_confidence : merged_confidence();
    }
    return library.confidence ? *library.confidence : general_confidence();
}

}  // namespace

SceneSearch::SceneSearch(const EntryIndex& index, std::span<const ModelProbe> probes, Scan scan,
                         const RecognitionSettings& settings, const Stopwatch& since_start)
    : index_(index),
      probes_(probes),
      scan_(std::move(scan)),
      settings_(settings),
      since_start_(since_start),
      confidence_model_(model_of(index.library(), scan_)),
      proposed_(probes.size()) {}

void SceneSearch::run() {
    if (settings_.use_keypoints) propose_by_keypoints();
    if (settings_.use_faces) propose_by_faces();
    bool found = play_round(0);
    if (settings_.use_segments) {
        propose_by_segments();
        found = play_round(1) || found;
    }
    for (int round = 2; round < kMaxRounds && found; ++round) found = play_round(round);
    try_turns();
}

void SceneSearch::propose_by_keypoints() {
    if (expired()) return;
    Stopwatch watch;
    const auto matches =
        match_keypoints(scan_, index_.library().settings, index_.keypoints(), settings_);
    parallel_for(matches.size(), [&](std::size_t m) {
        for (const Pose& pose : poses_from_matches(matches[m], 2.0 * scan_.sampling)) {
            proposed_[m].push_back({.model = static_cast<std::uint32_t>(m),
                                    .T_scene_model = pose,
                                    .source = HypothesisSource::keypoints});
        }
    });
    seconds_["keypoints"] += watch.lap();
}

void SceneSearch::propose_by_faces() {
    if (expired()) return;
    const auto flat = [](const ModelProbe& probe) { return !probe.faces().empty(); };
    if (std::none_of(probes_.begin(), probes_.end(), flat)) return;
    Stopwatch watch;
    const std::vector<FlatFace> faces = flat_faces(scan_.cloud, scan_.sampling);
    // Strips that are too narrow for the search for tables and walls: the rim of a bin is no plate.
    for (const FlatFace& face : faces) {
        for (const std::uint32_t i : face.indices) {
            float& extent = scan_.plane_extents[i];
            const auto own = static_cast<float>(face.extent);
            extent = extent > 0.0F ? std::min(extent, own) : own;
        }
    }
    parallel_for(probes_.size(), [&](std::size_t m) {
        if (!asked_for(m)) return;
        for (const Pose& pose : poses_from_faces(faces, probes_[m].faces(),
                                                 kFaceSlack * scan_.sampling, kMostByFaces)) {
            proposed_[m].push_back({.model = static_cast<std::uint32_t>(m),
                                    .T_scene_model = pose,
                                    .source = HypothesisSource::faces});
        }
    });
    seconds_["faces"] += watch.lap();
}

void SceneSearch::propose_by_segments() {
    if (expired() || unexplained() < kMinLeft) return;
    Stopwatch watch;
    for (const Hypothesis& h : hypotheses_from_segments(scan_, index_, settings_)) {
        proposed_[h.model].push_back(h);
    }
    seconds_["segments"] += watch.lap();
}

// Whether it found something that was not explained before.
bool SceneSearch::play_round(int number) {
    if (expired() || unexplained() < kMinLeft) return false;
    Stopwatch watch;
    const std::vector<Hypothesis> finalists = refined();
    seconds_["refine"] += watch.lap();
    verify_new(finalists, number);
    const std::size_t before = unexplained();
    const std::size_t after = mark_explained();
    seconds_["verify"] += watch.lap();
    return after + kMinLeft / 2 < before;
}

std::vector<Hypothesis> SceneSearch::refined() {
    std::vector<std::vector<Hypothesis>> of_model(probes_.size());
    parallel_for(probes_.size(), [&](std::size_t m) {
        if (!late() && asked_for(m))
            of_model[m] = refine_hypotheses(scan_, probes_[m], proposed_[m], settings_);
    });
    expired();
    std::vector<Hypothesis> all;
    for (const auto& some : of_model) {
        for (const Hypothesis& finalist : some) {
            const MeshShape& shape = probes_[finalist.model].model().shape;
            const bool known =
                std::any_of(judged_.begin(), judged_.end(), [&](const Judged& other) {
                    const Hypothesis& h = other.verified.hypothesis;
                    return h.model == finalist.model &&
                           nearly_equal(h.T_scene_model, finalist.T_scene_model, shape,
                                        kTwin * scan_.sampling);
                });
            if (!known) all.push_back(finalist);
        }
    }
    return all;
}

Judged SceneSearch::judge(const Hypothesis& hypothesis, int round) const {
    const double tolerance = settings_.tolerance * scan_.sampling;
    Judged one;
    one.verified = verify(scan_, probes_[hypothesis.model], hypothesis, tolerance);
    one.features = features_of(one.verified);
    one.round = round;
    one.verified.confidence =
        too_small(one.verified) ? 0.0 : confidence_model_.confidence(one.features);
    return one;
}

void SceneSearch::verify_new(const std::vector<Hypothesis>& finalists, int round) {
    std::vector<Judged> fresh(finalists.size());
    parallel_for(finalists.size(), [&](std::size_t i) { fresh[i] = judge(finalists[i], round); });
    for (Judged& one : fresh) judged_.push_back(std::move(one));
}

// What was found of models that are nearly symmetric may be a turn off. Which turn is right only
// the measurements of all cells can tell: confidence hardly changes.
void SceneSearch::try_turns() {
    if (expired()) return;
    Stopwatch watch;
    scan_.explained.clear();
    for (const std::size_t found : explanation(kAccept)) {
        if (expired()) break;
        if (probes_[judged_[found].verified.hypothesis.model].turns().empty()) continue;
        const Judged best = best_turn(judged_[found]);
        if (fits_better(best.verified, judged_[found].verified)) judged_[found] = best;
    }
    seconds_["turns"] += watch.lap();
}

// The best of what is turned, refined. The model has turns.
Judged SceneSearch::best_turn(const Judged& found) const {
    const auto better = [](const Judged& a, const Judged& b) {
        return a.verified.depth_fit > b.verified.depth_fit;
    };
    const Hypothesis& hypothesis = found.verified.hypothesis;
    const ModelProbe& probe = probes_[hypothesis.model];
    const double reach =
        std::max(kTurnReach * scan_.sampling, kTurnShare * probe.model().shape.diameter);
    std::vector<Judged> turned(probe.turns().size());
    parallel_for(turned.size(), [&](std::size_t i) {
        Hypothesis one = hypothesis;
        one.T_scene_model = refine_pose(scan_, probe, hypothesis.T_scene_model * probe.turns()[i],
                                        kTurnPoints, reach);
        turned[i] = judge(one, found.round);
    });
    std::stable_sort(turned.begin(), turned.end(), better);
    turned.resize(std::min(turned.size(), kTurnsRefined));
    parallel_for(turned.size(), [&](std::size_t i) {
        Hypothesis one = turned[i].verified.hypothesis;
        one.T_scene_model = refine_finely(scan_, probe, one.T_scene_model);
        turned[i] = judge(one, found.round);
    });
    return *std::min_element(turned.begin(), turned.end(), better);
}

std::size_t SceneSearch::mark_explained() {
    scan_.explained.assign(scan_.cloud.size(), 0);
    for (const std::size_t i : explanation(kAccept)) {
        const Verified& object = judged_[i].verified;
        mark_points(object, probes_[object.hypothesis.model], scan_);
    }
    return unexplained();
}

std::size_t SceneSearch::unexplained() const {
    if (scan_.explained.empty()) return scan_.cloud.size();
    return static_cast<std::size_t>(
        std::count(scan_.explained.begin(), scan_.explained.end(), char{0}));
}

std::vector<const Verified*> SceneSearch::verified() const {
    std::vector<const Verified*> all;
    for (const Judged& one : judged_) all.push_back(&one.verified);
    return all;
}

// What wins over its rivals only by a little is in doubt, but its rivals are not right for that:
// who wins is decided before.
std::vector<std::size_t> SceneSearch::explanation(double min_confidence) const {
    std::vector<std::pair<double, std::size_t>> sure;
    for (const std::size_t i : choose(verified(), min_confidence)) {
        const double confidence = standing(i).confidence;
        if (confidence >= min_confidence) sure.emplace_back(confidence, i);
    }
    std::stable_sort(sure.begin(), sure.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::size_t> numbers;
    for (const auto& [confidence, i] : sure) numbers.push_back(i);
    return numbers;
}

Standing SceneSearch::standing(std::size_t number) const {
    const Judged& one = judged_[number];
    Standing result{.features = one.features, .confidence = one.verified.confidence};
    const Rivals rivals = rivals_of(one.verified, verified());
    if (rivals.odds == 0.0) return result;
    result.rival_model = judged_[rivals.likeliest].verified.hypothesis.model;
    result.features[static_cast<std::size_t>(Feature::rival)] = std::log1p(rivals.odds);
    if (!too_small(one.verified)) result.confidence = confidence_model_.confidence(result.features);
    return result;
}

bool SceneSearch::asked_for(std::size_t model) const {
    return settings_.only.empty() ||
           std::find(settings_.only.begin(), settings_.only.end(), model) != settings_.only.end();
}

bool SceneSearch::late() const {
    return settings_.time_limit > 0.0 && since_start_.seconds() > settings_.time_limit;
}

bool SceneSearch::expired() {
    out_of_time_ = out_of_time_ || late();
    return out_of_time_;
}

}  // namespace ostraka
