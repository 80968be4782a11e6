// SPDX-License-Identifier: Apache-2.0
// Lowe. Distinctive Image Features from Scale-Invariant Keypoints. IJCV 60(2), 2004, section 6.
#include "ostraka/descriptors/depth_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/descriptors/fast_math.hpp"

namespace ostraka {
namespace {

constexpr float kEmpty = -std::numeric_limits<float>::infinity();
constexpr int kMiddle = kPatchSide / 2;  // pixel
constexpr int kSquares = 4;
constexpr int kDirections = 8;
constexpr double kSquareSide = 6.0;  // pixels: 3 times the toolbox' scale of 2
constexpr double kWindow = 2.0;      // deviation of the Gaussian window, in squares
constexpr double kLargest = 0.2;     // of a bin, before the second normalization

// Center of a pixel in [-1, 1].
double pixel_center(int pixel) {
    return (2.0 * pixel + 1.0) / kPatchSide - 1.0;
}

// Cross product of b - a and p - a.
double side_of(const Vec3d& a, const Vec3d& b, double x, double y) {
    return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

// Differences between the neighbors of a pixel; one-sided at the border.
double slope(const DepthPatch& patch, int x, int y, bool along_x) {
    const int at = along_x ? x : y;
    const int before = std::max(at - 1, 0);
    const int after = std::min(at + 1, kPatchSide - 1);
    const double difference = along_x ? double{patch.at(after, y)} - double{patch.at(before, y)}
                                      : double{patch.at(x, after)} - double{patch.at(x, before)};
    return difference / (after - before);
}

using Bins = std::array<double, kSquares * kSquares * kDirections>;

// Shares a gradient among the bins around it: column, row and direction.
void add_gradient(double column, double line, double direction, double weight, Bins& bins) {
    const double column_low = std::floor(column);
    const double line_low = std::floor(line);
    const double direction_low = std::floor(direction);
    for (int corner = 0; corner < 8; ++corner) {
        const int c = static_cast<int>(column_low) + (corner & 1);
        const int l = static_cast<int>(line_low) + (corner >> 1 & 1);
        const int d = (static_cast<int>(direction_low) + (corner >> 2)) % kDirections;
        if (c < 0 || c >= kSquares || l < 0 || l >= kSquares) continue;
        const double share = (1.0 - std::abs(column - c)) * (1.0 - std::abs(line - l)) *
                             (1.0 - std::abs(direction - direction_low - (corner >> 2)));
        const int bin = (l * kSquares + c) * kDirections + d;
        bins[static_cast<std::size_t>(bin)] += weight * share;
    }
}

// False if there is nothing to normalize.
bool normalize(Bins& bins) {
    double squares = 0.0;
    for (const double bin : bins) squares += bin * bin;
    if (!(squares > 0.0)) return false;
    for (double& bin : bins) bin /= std::sqrt(squares);
    return true;
}

}  // namespace

DepthPatch::DepthPatch() {
    height.fill(kEmpty);
}

void draw_triangle(const std::array<Vec3d, 3>& corners, DepthPatch& patch) {
    const auto& [a, b, c] = corners;
    const double area = side_of(a, b, c.x(), c.y());
    if (area == 0.0) return;
    const auto first = [](double low) {
        return std::max(
            0, static_cast<int>(std::ceil((std::max(low, -1.0) + 1.0) * 0.5 * kPatchSide - 0.5)));
    };
    const auto last = [](double high) {
        return std::min(
            kPatchSide - 1,
            static_cast<int>(std::floor((std::min(high, 1.0) + 1.0) * 0.5 * kPatchSide - 0.5)));
    };
    for (int y = first(std::min({a.y(), b.y(), c.y()})); y <= last(std::max({a.y(), b.y(), c.y()}));
         ++y) {
        for (int x = first(std::min({a.x(), b.x(), c.x()}));
             x <= last(std::max({a.x(), b.x(), c.x()})); ++x) {
            const double px = pixel_center(x);
            const double py = pixel_center(y);
            const double u = side_of(b, c, px, py) / area;
            const double v = side_of(c, a, px, py) / area;
            const double w = side_of(a, b, px, py) / area;
            if (u < 0.0 || v < 0.0 || w < 0.0) continue;
            float& height = patch.at(x, y);
            height = std::max(height, static_cast<float>(u * a.z() + v * b.z() + w * c.z()));
        }
    }
}

bool fill_background(DepthPatch& patch) {
    float lowest = std::numeric_limits<float>::infinity();
    for (const float height : patch.height) {
        if (height != kEmpty) lowest = std::min(lowest, height);
    }
    if (std::isinf(lowest)) return false;
    for (float& height : patch.height) {
        if (height == kEmpty) height = lowest;
    }
    patch.at(kMiddle, kMiddle) =
        0.25F * (patch.at(kMiddle - 1, kMiddle) + patch.at(kMiddle + 1, kMiddle) +
                 patch.at(kMiddle, kMiddle - 1) + patch.at(kMiddle, kMiddle + 1));
    return true;
}

void add_sift(const DepthPatch& patch, std::span<float> row) {
    Bins bins{};
    for (int y = 0; y < kPatchSide; ++y) {
        for (int x = 0; x < kPatchSide; ++x) {
            const double dx = slope(patch, x, y, true);
            const double dy = slope(patch, x, y, false);
            const double length = std::sqrt(dx * dx + dy * dy);
            if (!(length > 0.0)) continue;
            const double angle = fast_atan2(static_cast<float>(dy), static_cast<float>(dx));
            const double direction =
                (angle < 0.0 ? angle + 2.0 * kPi : angle) * kDirections / (2.0 * kPi);
            // In squares from the middle of the patch.
            const double right = (x - kMiddle) / kSquareSide;
            const double up = (y - kMiddle) / kSquareSide;
            const double window = std::exp(-(right * right + up * up) / (2.0 * kWindow * kWindow));
            const double middle = 0.5 * (kSquares - 1);
            add_gradient(right + middle, up + middle, direction, window * length, bins);
        }
    }
    if (!normalize(bins)) return;
    for (double& bin : bins) bin = std::min(bin, kLargest);
    normalize(bins);
    for (std::size_t b = 0; b < bins.size(); ++b) row[b] += static_cast<float>(bins[b]);
}

DepthPatch turned_by_half(const DepthPatch& patch) {
    DepthPatch turned = patch;
    std::reverse(turned.height.begin(), turned.height.end());
    return turned;
}

}  // namespace ostraka
