// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/range_smoothing.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinPoints = 100;
constexpr double kCellPitch = 1.5;   // side of a cell, in pitches: about two points each
constexpr double kMinForward = 0.2;  // cosine: points farther off the axis stay as they are
constexpr std::size_t kMaxCells = 1U << 24U;
constexpr std::size_t kNoiseSamples = 4000;
constexpr std::size_t kGrain = 4096;  // points that a thread takes at a time
constexpr int kMinSupport = 8;        // points that a plane is fitted to
constexpr double kSteepest = 1.5;     // slope that a surface may have at first
constexpr int kRefits = 2;
constexpr double kGate = 2.5;  // residuals beyond so many deviations are another surface

// Sums over points of the products of (1, u, v, d): u and v are image coordinates in cells, d is
// the shortening of the depth in spacings, to first order.
struct Moments {
    double n = 0.0, u = 0.0, v = 0.0, d = 0.0;
    double uu = 0.0, uv = 0.0, vv = 0.0, ud = 0.0, vd = 0.0, dd = 0.0;

    void add(const Moments& other) {
        n += other.n, u += other.u, v += other.v, d += other.d;
        uu += other.uu, uv += other.uv, vv += other.vv;
        ud += other.ud, vd += other.vd, dd += other.dd;
    }
};

// d = offset + slope . ((u, v) - center).
struct ImagePlane {
    Vec2d center = Vec2d::Zero();
    Vec2d slope = Vec2d::Zero();
    double offset = 0.0;
    double squared_residual = 0.0;  // mean, free of the fit's three parameters
    double at(double u, double v) const {
        return offset + slope.x() * (u - center.x()) + slope.y() * (v - center.y());
    }
};

std::optional<ImagePlane> fit(const Moments& sums) {
    if (sums.n < kMinSupport) return std::nullopt;
    ImagePlane plane;
    plane.center = Vec2d(sums.u, sums.v) / sums.n;
    plane.offset = sums.d / sums.n;
    const double uu = sums.uu - sums.n * plane.center.x() * plane.center.x();
    const double uv = sums.uv - sums.n * plane.center.x() * plane.center.y();
    const double vv = sums.vv - sums.n * plane.center.y() * plane.center.y();
    const double ud = sums.ud - sums.n * plane.center.x() * plane.offset;
    const double vd = sums.vd - sums.n * plane.center.y() * plane.offset;
    const double determinant = uu * vv - uv * uv;
    // Points in a row of the image have no plane.
    if (!(determinant > 0.02 * sums.n * sums.n)) return std::nullopt;
    plane.slope = Vec2d(vv * ud - uv * vd, uu * vd - uv * ud) / determinant;
    const double dd = sums.dd - sums.n * plane.offset * plane.offset;
    const double explained = plane.slope.x() * ud + plane.slope.y() * vd;
    plane.squared_residual = std::max(0.0, dd - explained) / (sums.n - 3.0);
    return plane;
}

// The scan as an image, at its own resolution.
class RangeImage {
  public:
    RangeImage(const PointCloud& cloud, double spacing) : cloud_(cloud), spacing_(spacing) {
        place_axis();
        if (depth_ > 0.0) project();
    }

    bool usable() const { return width_ > 0; }
    /// Side of a cell on a surface across the line of sight at the mean depth, in spacings.
    double cell() const { return cell_ * depth_ / spacing_; }
    /// Standard deviation of one point's depth, in spacings.
    double noise() const;
    /// New depths onto planes within a radius in cells.
    PointCloud smoothed(int radius, double noise) const;

  private:
    void place_axis();
    void project();
    double pixel_pitch(const Vec2d& low, const Vec2d& high) const;
    void fill_cells();
    using CellPlanes = std::vector<std::optional<ImagePlane>>;
    CellPlanes fit_planes(int radius, double noise) const;
    /// The image of what the planes leave.
    RangeImage without(const CellPlanes& planes) const;
    std::optional<ImagePlane> surface_at(int column, int row, int radius, double noise) const;
    double middle(int column, int row) const;

    const Moments& at(int column, int row) const {
        return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(column)];
    }
    template <class Use>
    void around(int column, int row, int radius, const Use& use) const {
        for (int y = std::max(0, row - radius); y <= std::min(height_ - 1, row + radius); ++y) {
            const double across = static_cast<double>(y - row);
            const double edge = radius + 0.5;
            const int reach = static_cast<int>(std::sqrt(edge * edge - across * across));
            const int last = std::min(width_ - 1, column + reach);
            for (int x = std::max(0, column - reach); x <= last; ++x) {
                if (at(x, y).n > 0.0) use(at(x, y), x, y);
            }
        }
    }

    const PointCloud& cloud_;
    double spacing_;
    Mat3d R_image_cloud_ = Mat3d::Identity();
    double depth_ = 0.0;  // mean, along the axis
    double cell_ = 0.0;   // side, in the image at depth 1
    int width_ = 0;
    int height_ = 0;
    std::vector<Vec3d> image_;            // u, v in cells; d. NaN: not in the image
    std::vector<std::uint32_t> cell_of_;  // of each point
    std::vector<Moments> cells_;          // row-major
};

void RangeImage::place_axis() {
    Vec3d sum = Vec3d::Zero();
    double count = 0.0;
    for (const Vec3f& point : cloud_.points) {
        if (!point.allFinite()) continue;
        sum += (point - cloud_.viewpoint).cast<double>();
        count += 1.0;
    }
    if (count < double{kMinPoints} || !(sum.norm() > 0.0)) return;
    const Vec3d axis = sum.normalized();
    const Vec3d side = axis.unitOrthogonal();
    R_image_cloud_.row(0) = side;
    R_image_cloud_.row(1) = axis.cross(side);
    R_image_cloud_.row(2) = axis;
    depth_ = sum.dot(axis) / count;
}

// From the number of points in well-filled patches of the image.
double RangeImage::pixel_pitch(const Vec2d& low, const Vec2d& high) const {
    constexpr double kPatchPoints = 40.0;
    const Vec2d extent = high - low;
    const double area = extent.x() * extent.y();
    if (!(area > 0.0)) return 0.0;
    const double side = std::sqrt(area * kPatchPoints / static_cast<double>(image_.size()));
    const auto columns = static_cast<std::size_t>(extent.x() / side) + 1;
    const auto rows = static_cast<std::size_t>(extent.y() / side) + 1;
    if (columns * rows > 4 * image_.size()) return 0.0;  // a sliver: not an image
    std::vector<double> counts(columns * rows, 0.0);
    for (const Vec3d& place : image_) {
        if (!place.allFinite()) continue;
        const auto x = static_cast<std::size_t>((place.x() - low.x()) / side);
        const auto y = static_cast<std::size_t>((place.y() - low.y()) / side);
        counts[std::min(y, rows - 1) * columns + std::min(x, columns - 1)] += 1.0;
    }
    std::erase(counts, 0.0);
    const auto well_filled = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() * 7 / 10);
    std::nth_element(counts.begin(), well_filled, counts.end());
    return side / std::sqrt(*well_filled);
}

void RangeImage::project() {
    const Vec3d nowhere = Vec3d::Constant(std::numeric_limits<double>::quiet_NaN());
    image_.assign(cloud_.size(), nowhere);
    parallel_for(
        cloud_.size(),
        [&](std::size_t i) {
            if (!cloud_.points[i].allFinite()) return;
            const Vec3d p = R_image_cloud_ * (cloud_.points[i] - cloud_.viewpoint).cast<double>();
            if (!(p.z() > kMinForward * p.norm())) return;
            image_[i] = Vec3d(p.x() / p.z(), p.y() / p.z(), depth_ / p.z());
        },
        kGrain);
    Vec2d low = Vec2d::Constant(std::numeric_limits<double>::max());
    Vec2d high = -low;
    for (const Vec3d& place : image_) {
        if (!std::isfinite(place.x())) continue;
        low = low.cwiseMin(place.head<2>());
        high = high.cwiseMax(place.head<2>());
    }
    cell_ = kCellPitch * pixel_pitch(low, high);
    if (!(cell_ > 0.0)) return;
    const Vec2d cells = (high - low) / cell_;
    if (!((cells.x() + 1.0) * (cells.y() + 1.0) < double{kMaxCells})) return;
    width_ = static_cast<int>(cells.x()) + 1;
    height_ = static_cast<int>(cells.y()) + 1;
    cell_of_.assign(cloud_.size(), kNoIndex);
    parallel_for(
        cloud_.size(),
        [&](std::size_t i) {
            Vec3d& place = image_[i];
            if (!std::isfinite(place.x())) return;
            const double u = (place.x() - low.x()) / cell_;
            const double v = (place.y() - low.y()) / cell_;
            const double d = (place.z() - 1.0) * depth_ / spacing_;
            place = Vec3d(u, v, d);
            cell_of_[i] = static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(width_) +
                          static_cast<std::uint32_t>(u);
        },
        kGrain);
    fill_cells();
}

void RangeImage::fill_cells() {
    cells_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), {});
    for (std::size_t i = 0; i < image_.size(); ++i) {
        if (cell_of_[i] == kNoIndex) continue;
        const double u = image_[i].x();
        const double v = image_[i].y();
        const double d = image_[i].z();
        cells_[cell_of_[i]].add({1.0, u, v, d, u * u, u * v, v * v, u * d, v * d, d * d});
    }
}

double RangeImage::noise() const {
    std::vector<std::size_t> filled;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (cells_[c].n > 0.0) filled.push_back(c);
    }
    std::vector<double> squares;
    const std::size_t stride = 1 + filled.size() / kNoiseSamples;
    for (std::size_t i = 0; i < filled.size(); i += stride) {
        const int column = static_cast<int>(filled[i] % static_cast<std::size_t>(width_));
        const int row = static_cast<int>(filled[i] / static_cast<std::size_t>(width_));
        Moments sums;
        around(column, row, 1, [&](const Moments& cell, int, int) { sums.add(cell); });
        if (const auto plane = fit(sums)) squares.push_back(plane->squared_residual);
    }
    if (squares.size() < 20) return 0.0;
    const auto median = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), median, squares.end());
    return std::sqrt(*median);
}

// The median of the mean depths around a cell: where its surface is, whatever lies beside it.
double RangeImage::middle(int column, int row) const {
    std::array<double, 9> means{};
    std::size_t count = 0;
    around(column, row, 1, [&](const Moments& cell, int, int) {
        if (count < means.size()) means[count++] = cell.d / cell.n;
    });
    const auto median = means.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(means.begin(), median, means.begin() + static_cast<std::ptrdiff_t>(count));
    return *median;
}

std::optional<ImagePlane> RangeImage::surface_at(int column, int row, int radius,
                                                 double noise) const {
    const double start = middle(column, row);
    Moments sums;
    around(column, row, radius, [&](const Moments& cell, int x, int y) {
        const double distance = this->cell() * std::hypot(x - column, y - row);
        const double limit = kGate * noise / std::sqrt(cell.n) + noise + kSteepest * distance;
        if (std::abs(cell.d / cell.n - start) < limit) sums.add(cell);
    });
    std::optional<ImagePlane> plane = fit(sums);
    for (int refit = 0; refit < kRefits && plane; ++refit) {
        Moments near;
        around(column, row, radius, [&](const Moments& cell, int, int) {
            const double off = cell.d / cell.n - plane->at(cell.u / cell.n, cell.v / cell.n);
            if (std::abs(off) < kGate * noise / std::sqrt(cell.n) + 0.25) near.add(cell);
        });
        const auto better = fit(near);
        if (!better) break;
        plane = better;
    }
    return plane;
}

RangeImage::CellPlanes RangeImage::fit_planes(int radius, double noise) const {
    CellPlanes planes(cells_.size());
    parallel_for(static_cast<std::size_t>(height_), [&](std::size_t row) {
        for (int column = 0; column < width_; ++column) {
            if (!(at(column, static_cast<int>(row)).n > 0.0)) continue;
            planes[row * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)] =
                surface_at(column, static_cast<int>(row), radius, noise);
        }
    });
    return planes;
}

RangeImage RangeImage::without(const CellPlanes& planes) const {
    RangeImage rest = *this;
    parallel_for(
        image_.size(),
        [&](std::size_t i) {
            if (cell_of_[i] == kNoIndex) return;
            const auto& plane = planes[cell_of_[i]];
            if (plane) {
                rest.image_[i].z() -= plane->at(image_[i].x(), image_[i].y());
            } else {
                rest.cell_of_[i] = kNoIndex;
            }
        },
        kGrain);
    rest.fill_cells();
    return rest;
}

PointCloud RangeImage::smoothed(int radius, double noise) const {
    const CellPlanes planes = fit_planes(radius, noise);
    // Twicing: planes in curved surface lie off it by the same in all the window; what they leave
    // shows by how much.
    const CellPlanes corrections = without(planes).fit_planes(radius, noise);
    PointCloud result = cloud_;
    result.normals.clear();
    parallel_for(
        cloud_.size(),
        [&](std::size_t i) {
            if (cell_of_[i] == kNoIndex) return;
            const auto& plane = planes[cell_of_[i]];
            if (!plane) return;
            const double old_depth = depth_ / (image_[i].z() * spacing_ / depth_ + 1.0);
            double d = plane->at(image_[i].x(), image_[i].y());
            if (const auto& correction = corrections[cell_of_[i]]) {
                d += correction->at(image_[i].x(), image_[i].y());
            }
            const double depth = depth_ / (d * spacing_ / depth_ + 1.0);
            if (!(std::abs(depth - old_depth) < 6.0 * noise * spacing_)) return;
            const Vec3d ray = (cloud_.points[i] - cloud_.viewpoint).cast<double>() / old_depth;
            result.points[i] = (cloud_.viewpoint.cast<double>() + depth * ray).cast<float>();
        },
        kGrain);
    return result;
}

void require_spacing(double spacing) {
    if (!(spacing > 0.0)) throw InvalidInput("smoothing ranges: the spacing must be positive");
}

// Of the window, in cells; 0: none is needed, or none is wide enough to help.
int window_radius(double deviation, double pitch, const RangeSmoothingSettings& settings) {
    // A window of radius r pitches averages pi r^2 points.
    const double wanted = deviation / (settings.target * settings.spacing * std::sqrt(kPi));
    const double pixels = std::min(wanted, settings.max_radius * settings.spacing / pitch);
    return static_cast<int>(std::lround(pixels / kCellPitch));
}

}  // namespace

RangeNoise measure_range_noise(const PointCloud& cloud, double spacing) {
    require_spacing(spacing);
    const RangeImage image(cloud, spacing);
    if (!image.usable()) return {};
    return {image.noise() * spacing, image.cell() / kCellPitch * spacing};
}

double remaining_deviation(const RangeNoise& noise, const RangeSmoothingSettings& settings) {
    require_spacing(settings.spacing);
    if (!(noise.pitch > 0.0)) return noise.deviation;
    const int radius = window_radius(noise.deviation, noise.pitch, settings);
    if (radius < 1) return noise.deviation;
    return noise.deviation / (std::sqrt(kPi) * kCellPitch * radius);
}

PointCloud smooth_ranges(const PointCloud& cloud, const RangeSmoothingSettings& settings) {
    require_spacing(settings.spacing);
    const RangeImage image(cloud, settings.spacing);
    if (!image.usable()) return cloud;
    const double noise = image.noise();
    const double pitch = image.cell() / kCellPitch;
    const int radius = window_radius(noise * settings.spacing, pitch * settings.spacing, settings);
    return radius >= 1 ? image.smoothed(radius, noise) : cloud;
}

}  // namespace ostraka
