// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/outline.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "ostraka/recognition/verdict_image.hpp"

namespace ostraka {
namespace {

constexpr int kInward = 2;               // cells from the outline into the model, past the rim,
constexpr int kOutward = 3;              // and out of it, where normals are those of one side only
constexpr int kWidestEdge = 3;           // cells of edge; a thin brim has more than one
constexpr float kContinues = 0.9F;       // cosine between normals on both sides of a smooth surface
constexpr std::size_t kMinOutline = 12;  // cells of outline; fewer say nothing
constexpr float kFoldSlack = 1.5F;       // sampling distances from a face's plane to the rim, and
constexpr float kFoldReach = 8.0F;       // from a place on the face, if it begins at the rim
constexpr int kAround = 3;               // cells around one that give the outline's direction

// A place where the supported part ends, in the direction of one of the four sides of a cell.
struct Brink {
    std::uint32_t inside = kNoIndex;   // kInward cells into the model
    std::uint32_t rim = kNoIndex;      // its last cell
    std::uint32_t outside = kNoIndex;  // kOutward cells from there
};

enum class Beyond : std::uint8_t { unknown, open, joined, nearer, level, folded, ended };

// Whether a supported cell and one beyond the outline show one smooth surface.
bool continues(const Scan& scan, const VerdictImage& image, const Brink& brink) {
    const std::uint32_t a = scan.ranges[brink.inside].point;
    const std::uint32_t b = scan.ranges[brink.outside].point;
    if (b == kNoIndex) return false;
    // A cell may have borrowed its point from the rim of the model.
    const std::uint32_t own = scan.ranges.cell_of(scan.cloud.points[b]);
    if (own == kNoIndex || !image.lacks(image.u(own), image.v(own))) return false;
    const Vec3f& normal = scan.cloud.normals[a];
    if (normal.dot(scan.cloud.normals[b]) < kContinues) return false;
    const float off = normal.dot(scan.cloud.points[b] - scan.cloud.points[a]);
    return std::abs(off) < static_cast<float>(scan.sampling);
}

Vec3f seen_at(const RangeMap& ranges, std::uint32_t cell) {
    return ranges.viewpoint() + ranges[cell].near * ranges.direction(cell).cast<float>();
}

// Where the rim's ray meets the plane of the surface inside it. Not what is seen there: in a cell
// at the edge of something in front that is nearer.
// @param a  point of the cloud, on the surface. Infinite where the ray runs along it.
Vec3f rim_of(const Scan& scan, std::uint32_t a, std::uint32_t rim) {
    const Vec3f ray = scan.ranges.direction(rim).cast<float>();
    const Vec3f& normal = scan.cloud.normals[a];
    const Vec3f& eye = scan.ranges.viewpoint();
    return eye + normal.dot(scan.cloud.points[a] - eye) / normal.dot(ray) * ray;
}

// Whether a face begins at the rim: its plane goes through it.
// @param point  of the cloud, on the face, or kNoIndex. @param back  from there to the rim.
bool begins_at(const Scan& scan, std::uint32_t point, const Vec3f& back) {
    if (point == kNoIndex) return false;
    const auto sampling = static_cast<float>(scan.sampling);
    return std::abs(scan.cloud.normals[point].dot(back)) < kFoldSlack * sampling &&
           back.norm() < kFoldReach * sampling;
}

Beyond beyond(const Scan& scan, const VerdictImage& image, const Brink& brink) {
    if (brink.inside == kNoIndex || brink.outside == kNoIndex) return Beyond::unknown;
    const std::uint32_t a = scan.ranges[brink.inside].point;
    if (a == kNoIndex) return Beyond::unknown;
    // Nothing behind it, or too far away, or in its shadow: had the surface gone on, it were seen.
    if (!scan.ranges[brink.outside].measured()) return Beyond::ended;
    if (continues(scan, image, brink)) return Beyond::open;
    const auto sampling = static_cast<float>(scan.sampling);
    const Vec3f outside = seen_at(scan.ranges, brink.outside);
    const float above = scan.cloud.normals[a].dot(outside - scan.cloud.points[a]);
    if (std::abs(above) <= sampling) return Beyond::level;
    const bool face =
        begins_at(scan, scan.ranges[brink.outside].point, rim_of(scan, a, brink.rim) - outside);
    if (above > 0.0F) return face ? Beyond::joined : Beyond::nearer;
    return face ? Beyond::folded : Beyond::ended;
}

// Unit, out of the silhouette, in columns and rows; zero where it is all around.
Eigen::Vector2d outward(const VerdictImage& image, int u, int v) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int dv = -kAround; dv <= kAround; ++dv) {
        for (int du = -kAround; du <= kAround; ++du) {
            if (image.at(u + du, v + dv) == CellVerdict::outside) sum += Eigen::Vector2d(du, dv);
        }
    }
    return sum.isZero() ? sum : Eigen::Vector2d(sum.normalized());
}

struct OutlineSums {
    std::size_t outline = 0;     // also against what hides it
    std::size_t open = 0;        // of these
    std::size_t joined = 0;      // of these
    std::size_t silhouette = 0;  // where something is known of it
    std::size_t level = 0;       // of these
    std::size_t folded = 0;      // of these
    std::size_t fenced = 0;      // of these
    Eigen::Matrix2d ended = Eigen::Matrix2d::Zero();
};

// From a cell to the first one where the model's edge, which can't be judged, has ended.
int steps_off(const VerdictImage& image, int u, int v, const std::pair<int, int>& side) {
    int steps = 1;
    while (steps <= kWidestEdge &&
           image.at(u + steps * side.first, v + steps * side.second) == CellVerdict::unsure) {
        ++steps;
    }
    return steps;
}

void judge_brink(const Scan& scan, const VerdictImage& image, int u, int v,
                 const std::pair<int, int>& side, OutlineSums& sums) {
    const auto& [du, dv] = side;
    const auto lacks = [&](int steps) { return image.lacks(u + steps * du, v + steps * dv); };
    const auto ends = [&](int steps) { return image.beyond(u + steps * du, v + steps * dv); };
    const auto clear = [&](int steps) {
        return image.at(u + steps * du, v + steps * dv) == CellVerdict::outside;
    };
    const int first = steps_off(image, u, v, side);
    const int last = first + kOutward - 1;
    if (!lacks(first) || !lacks(last)) return;
    const int inner_u = u - kInward * du;
    const int inner_v = v - kInward * dv;
    if (image.at(inner_u, inner_v) != CellVerdict::support) return;
    const Beyond found = beyond(
        scan, image,
        {image.cell(inner_u, inner_v), image.cell(u, v), image.cell(u + last * du, v + last * dv)});
    // Inside the silhouette only what goes on tells: where the scan isn't what a side of the model
    // would be, but what is beside it.
    const bool over = ends(1) && ends(last);
    if (found == Beyond::open || over) ++sums.outline;
    if (found == Beyond::open) ++sums.open;
    if (found == Beyond::joined && over) ++sums.joined;
    if (found == Beyond::unknown || !clear(1) || !clear(last)) return;
    ++sums.silhouette;
    if (found == Beyond::level) ++sums.level;
    if (found == Beyond::folded) ++sums.folded;
    if (found == Beyond::nearer || found == Beyond::joined) ++sums.fenced;
    if (found != Beyond::ended) return;
    const Eigen::Vector2d direction = outward(image, u, v);
    sums.ended += direction * direction.transpose();
}

double share(std::size_t part, std::size_t whole, std::size_t least) {
    return whole < least ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

OutlineEvidence judge_outline(const Scan& scan, std::span<const std::uint32_t> window,
                              std::span<const CellVerdict> verdicts) {
    if (window.empty()) return {};
    const VerdictImage image(scan.ranges, window, verdicts);
    OutlineSums sums;
    for (std::size_t i = 0; i < window.size(); ++i) {
        if (verdicts[i] != CellVerdict::support) continue;
        for (const auto& side : kSides) {
            judge_brink(scan, image, image.u(window[i]), image.v(window[i]), side, sums);
        }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> directions(sums.ended,
                                                                    Eigen::EigenvaluesOnly);
    return {.open = share(sums.open, sums.outline, kMinOutline),
            .level = share(sums.level, sums.silhouette, 1),
            .folded = share(sums.folded, sums.silhouette, 1),
            .joined = share(sums.joined, sums.outline, kMinOutline),
            .fenced = share(sums.fenced, sums.silhouette, 1),
            .ended = 2.0 * std::max(0.0, directions.eigenvalues()(0))};
}

}  // namespace ostraka
