// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/surface_extents.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kPixels = 1.4;      // side of a cell, so that none of a closed surface stays empty
constexpr double kMinSlope = 0.1;    // cosine of incidence; of a plane hardly seen, at most
constexpr double kMostCells = 2048;  // along a side
constexpr int kSlopes = 4;           // of lines, up to 45 degrees; four times as many directions
constexpr int kThrough = 3;          // as many that end on it for each ray through a surface
constexpr int kMargin = 2;           // cells; edges are blurred
constexpr int kSpeckle = 7;          // of eight neighbors that close a cell

// What rays tell of a cell.
struct Rays {
    int on = 0;       // end on the plane
    int front = 0;    // end before it
    int through = 0;  // end behind it
};

enum class CellKind : char { open, front, surface };

CellKind kind_of(const Rays& rays) {
    if (rays.on > kThrough * rays.through) return CellKind::surface;
    return rays.front > 0 && rays.front >= rays.through ? CellKind::front : CellKind::open;
}

// Cells of a rectangle, row by row.
template <typename T>
struct Raster {
    int width = 0;
    int height = 0;
    std::vector<T> cells;

    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
    const T& at(int x, int y) const { return cells[index(x, y)]; }
};

// Single cells that nothing was measured in, or noise has emptied, are no gap: these are lines.
Raster<CellKind> closed_up(const Raster<Rays>& rays) {
    Raster<CellKind> kinds{rays.width, rays.height, {}};
    kinds.cells.reserve(rays.cells.size());
    for (const Rays& some : rays.cells) kinds.cells.push_back(kind_of(some));
    Raster<CellKind> closed = kinds;
    for (int y = 1; y + 1 < kinds.height; ++y) {
        for (int x = 1; x + 1 < kinds.width; ++x) {
            if (kinds.at(x, y) != CellKind::open) continue;
            int around = 0;
            for (int v = y - 1; v <= y + 1; ++v) {
                for (int u = x - 1; u <= x + 1; ++u) {
                    if (kinds.at(u, v) != CellKind::open) ++around;
                }
            }
            if (around >= kSpeckle) closed.cells[closed.index(x, y)] = CellKind::surface;
        }
    }
    return closed;
}

// Cells along one line, and the lengths of the runs of surface that they are in.
class Line {
  public:
    Line(const Raster<CellKind>& kinds, double step, std::vector<float>& lengths)
        : kinds_(kinds), step_(static_cast<float>(step)), lengths_(lengths) {}

    void visit(int x, int y) {
        const std::size_t cell = kinds_.index(x, y);
        if (kinds_.cells[cell] == CellKind::open) {
            end();
            return;
        }
        run_.push_back(cell);
        if (kinds_.cells[cell] == CellKind::surface) surface_end_ = run_.size();
    }
    // What is in front may hide the surface only where it goes on behind: ends don't count.
    void end() {
        std::size_t first = 0;
        while (first < surface_end_ && kinds_.cells[run_[first]] != CellKind::surface) ++first;
        const float length = step_ * static_cast<float>(surface_end_ - first);
        for (std::size_t i = first; i < surface_end_; ++i) {
            lengths_[run_[i]] = std::max(lengths_[run_[i]], length);
        }
        run_.clear();
        surface_end_ = 0;
    }

  private:
    const Raster<CellKind>& kinds_;
    float step_;
    std::vector<float>& lengths_;
    std::vector<std::size_t> run_;
    std::size_t surface_end_ = 0;  // one past the last cell of surface in the run
};

// All lines of one direction, each cell on one of them. @param rise  across a step along; -1 to 1.
void trace_lines(const Raster<CellKind>& kinds, double rise, bool upright, double side,
                 std::vector<float>& lengths) {
    const int along = upright ? kinds.height : kinds.width;
    const int across = upright ? kinds.width : kinds.height;
    const auto climb = [&](int i) { return static_cast<int>(std::lround(rise * i)); };
    const auto open = [&](int x, int y) { return kinds.at(x, y) == CellKind::open; };
    const int most = std::abs(climb(along));
    for (int start = -most; start < across + most; ++start) {
        Line line(kinds, side * std::hypot(1.0, rise), lengths);
        int last_x = -1;
        int last_y = -1;
        for (int i = 0; i < along; ++i) {
            const int x = upright ? start + climb(i) : i;
            const int y = upright ? i : start + climb(i);
            if (!kinds.holds(x, y)) continue;
            // A gap that runs at a slant is not slipped through.
            const bool slips = kinds.holds(last_x, last_y) && open(x, last_y) && open(last_x, y);
            if (slips) line.end();
            line.visit(x, y);
            last_x = x;
            last_y = y;
        }
        line.end();
    }
}

}  // namespace

SurfaceExtents::SurfaceExtents(const PlanePiece& piece, const PointCloud& scan, double pitch,
                               double slack)
    : T_piece_cloud_(piece.T_cloud_piece.inverse(Eigen::Isometry)), half_(0.5 * piece.extents) {
    const Vec3d eye = scan.viewpoint.cast<double>();
    const double slope =
        std::abs((eye - piece.T_cloud_piece.translation()).normalized().dot(piece.normal));
    side_ = std::max(kPixels * pitch / std::max(kMinSlope, slope),
                     piece.extents.maxCoeff() / kMostCells);
    width_ = static_cast<int>(piece.extents.x() / side_) + 1;
    height_ = static_cast<int>(piece.extents.y() / side_) + 1;
    Raster<Rays> rays{width_, height_, {}};
    rays.cells.resize(rays.index(0, height_));
    const double eye_height = piece.normal.dot(eye) - piece.offset;
    for (const Vec3f& point : scan.points) {
        const Vec3d end = point.cast<double>();
        const double height = piece.normal.dot(end) - piece.offset;
        const bool on = std::abs(height) < slack;
        const double fall = eye_height - height;
        if (!on && fall <= 0.0) continue;
        const Vec3d at = T_piece_cloud_ * (on ? end : eye + eye_height / fall * (end - eye));
        const int x = column(at.x());
        const int y = row(at.y());
        if (!rays.holds(x, y)) continue;
        Rays& cell = rays.cells[rays.index(x, y)];
        ++(on ? cell.on : height > 0.0 ? cell.front : cell.through);
    }
    const Raster<CellKind> kinds = closed_up(rays);
    lengths_.assign(kinds.cells.size(), 0.0F);
    for (int i = -kSlopes; i <= kSlopes; ++i) {
        trace_lines(kinds, static_cast<double>(i) / kSlopes, false, side_, lengths_);
        trace_lines(kinds, static_cast<double>(i) / kSlopes, true, side_, lengths_);
    }
}

double SurfaceExtents::at(const Vec3d& place) const {
    const Vec3d at = T_piece_cloud_ * place;
    const int x = column(at.x());
    const int y = row(at.y());
    float longest = 0.0F;
    for (int v = std::max(0, y - kMargin); v <= std::min(height_ - 1, y + kMargin); ++v) {
        for (int u = std::max(0, x - kMargin); u <= std::min(width_ - 1, x + kMargin); ++u) {
            longest = std::max(
                longest, lengths_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(u)]);
        }
    }
    return double{longest};
}

// Beside the piece, a number below 0 or beyond the last.
int SurfaceExtents::column(double x) const {
    return static_cast<int>(std::clamp(std::floor((x + half_.x()) / side_), -9.0, width_ + 9.0));
}

int SurfaceExtents::row(double y) const {
    return static_cast<int>(std::clamp(std::floor((y + half_.y()) / side_), -9.0, height_ + 9.0));
}

}  // namespace ostraka
