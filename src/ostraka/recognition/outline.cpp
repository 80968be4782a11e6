// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/outline.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr int kInward = 2;               // cells from the outline into the model, past the rim,
constexpr int kOutward = 3;              // and out of it, where normals are those of one side only
constexpr float kContinues = 0.9F;       // cosine between normals on both sides of a smooth surface
constexpr std::size_t kMinOutline = 12;  // cells of outline; fewer say nothing

// The verdicts by column u and row v of the range map.
class VerdictImage {
  public:
    VerdictImage(const RangeMap& ranges, std::span<const std::uint32_t> window,
                 std::span<const CellVerdict> verdicts)
        : width_(static_cast<int>(ranges.width())),
          height_(static_cast<int>(ranges.height())),
          low_u_(u(window.front())),
          low_v_(v(window.front())),
          columns_(u(window.back()) - low_u_ + 1),
          verdicts_(verdicts) {}

    CellVerdict at(int u, int v) const {
        const int column = u - low_u_;
        const int row = v - low_v_;
        if (column < 0 || row < 0 || column >= columns_) return CellVerdict::outside;
        const auto i = static_cast<std::size_t>(row * columns_ + column);
        return i < verdicts_.size() ? verdicts_[i] : CellVerdict::outside;
    }
    // Whether the visible part of the model has ended there.
    bool beyond(int u, int v) const {
        const CellVerdict verdict = at(u, v);
        return verdict == CellVerdict::outside || verdict == CellVerdict::hidden;
    }
    std::uint32_t cell(int u, int v) const {
        if (u < 0 || v < 0 || u >= width_ || v >= height_) return kNoIndex;
        return static_cast<std::uint32_t>(v * width_ + u);
    }
    int u(std::uint32_t cell) const { return static_cast<int>(cell) % width_; }
    int v(std::uint32_t cell) const { return static_cast<int>(cell) / width_; }

  private:
    int width_;
    int height_;
    int low_u_;
    int low_v_;
    int columns_;
    std::span<const CellVerdict> verdicts_;
};

// Whether a supported cell and one beyond the outline show one smooth surface.
bool continues(const Scan& scan, const VerdictImage& image, std::uint32_t inside,
               std::uint32_t outside) {
    if (inside == kNoIndex || outside == kNoIndex) return false;
    const std::uint32_t a = scan.ranges[inside].point;
    const std::uint32_t b = scan.ranges[outside].point;
    if (a == kNoIndex || b == kNoIndex || !scan.ranges[outside].measured()) return false;
    // A cell may have borrowed its point from the rim of the model.
    const std::uint32_t own = scan.ranges.cell_of(scan.cloud.points[b]);
    if (own == kNoIndex || !image.beyond(image.u(own), image.v(own))) return false;
    const Vec3f& normal = scan.cloud.normals[a];
    if (normal.dot(scan.cloud.normals[b]) < kContinues) return false;
    const float off = normal.dot(scan.cloud.points[b] - scan.cloud.points[a]);
    return std::abs(off) < static_cast<float>(scan.sampling);
}

}  // namespace

double open_share(const Scan& scan, std::span<const std::uint32_t> window,
                  std::span<const CellVerdict> verdicts) {
    if (window.empty()) return 0.0;
    const VerdictImage image(scan.ranges, window, verdicts);
    std::size_t outline = 0;
    std::size_t open = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
        if (verdicts[i] != CellVerdict::support) continue;
        const int u = image.u(window[i]);
        const int v = image.v(window[i]);
        for (const auto& [du, dv] :
             {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
            if (!image.beyond(u + du, v + dv)) continue;
            if (!image.beyond(u + kOutward * du, v + kOutward * dv)) continue;
            const int inner_u = u - kInward * du;
            const int inner_v = v - kInward * dv;
            if (image.at(inner_u, inner_v) != CellVerdict::support) continue;
            ++outline;
            const std::uint32_t outside = image.cell(u + kOutward * du, v + kOutward * dv);
            if (continues(scan, image, image.cell(inner_u, inner_v), outside)) ++open;
        }
    }
    return outline < kMinOutline ? 0.0 : static_cast<double>(open) / static_cast<double>(outline);
}

std::size_t solid_contradiction(const RangeMap& ranges, std::span<const std::uint32_t> window,
                                std::span<const CellVerdict> verdicts) {
    if (window.empty()) return 0;
    const VerdictImage image(ranges, window, verdicts);
    const auto contradicts = [&](int u, int v) {
        const CellVerdict verdict = image.at(u, v);
        return verdict == CellVerdict::violation || verdict == CellVerdict::backdrop;
    };
    return static_cast<std::size_t>(
        std::count_if(window.begin(), window.end(), [&](std::uint32_t cell) {
            for (int n = 0; n < 9; ++n) {
                if (!contradicts(image.u(cell) + n % 3 - 1, image.v(cell) + n / 3 - 1))
                    return false;
            }
            return true;
        }));
}

}  // namespace ostraka
