// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/surface_gaps.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kPixels = 1.4;    // side of a cell, so that none of a closed surface stays empty
constexpr double kMinSlope = 0.1;  // cosine of incidence; of a plane hardly seen, at most
constexpr int kMostCells = 4096;   // along a side

struct Cell {
    int on = 0;       // points on the plane
    int front = 0;    // rays that end before it
    int through = 0;  // rays that end behind it

    bool surface() const { return on > 0 && on >= through; }
    bool open() const { return !surface() && (front == 0 || front < through); }
};

// Cells over the rectangle of a piece.
class PlaneGrid {
  public:
    PlaneGrid(const PlanePiece& piece, double side)
        : T_piece_cloud_(piece.T_cloud_piece.inverse(Eigen::Isometry)),
          half_(0.5 * piece.extents),
          side_(side),
          width_(cells_along(piece.extents.x())),
          height_(cells_along(piece.extents.y())),
          cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

    int width() const { return width_; }
    int height() const { return height_; }
    const Cell& at(int x, int y) const { return cells_[index(x, y)]; }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }
    // Where the cell begins along one axis of the piece.
    double start(int cell, int axis) const { return cell * side_ - half_[axis]; }

    // The cell at a place on the plane; nullptr: beside the piece.
    Cell* find(const Vec3d& place) {
        const Vec3d at = T_piece_cloud_ * place;
        const double x = std::floor((at.x() + half_.x()) / side_);
        const double y = std::floor((at.y() + half_.y()) / side_);
        if (!(x >= 0.0 && y >= 0.0 && x < width_ && y < height_)) return nullptr;
        return &cells_[index(static_cast<int>(x), static_cast<int>(y))];
    }

  private:
    int cells_along(double extent) const {
        return static_cast<int>(std::clamp(std::ceil(extent / side_), 1.0, double{kMostCells}));
    }

    Pose T_piece_cloud_;
    Vec2d half_;
    double side_;
    int width_;
    int height_;
    std::vector<Cell> cells_;
};

// Where each ray meets the plane, and what it meets.
void trace(const PointCloud& scan, const PlanePiece& piece, double slack, PlaneGrid& grid) {
    const Vec3d eye = scan.viewpoint.cast<double>();
    const double eye_height = piece.normal.dot(eye) - piece.offset;
    for (const Vec3f& point : scan.points) {
        const Vec3d end = point.cast<double>();
        const double height = piece.normal.dot(end) - piece.offset;
        if (std::abs(height) < slack) {
            if (Cell* cell = grid.find(end)) ++cell->on;
            continue;
        }
        const double fall = eye_height - height;
        if (fall <= 0.0) continue;
        Cell* cell = grid.find(eye + eye_height / fall * (end - eye));
        if (cell == nullptr) continue;
        ++(height > 0.0 ? cell->front : cell->through);
    }
}

// A range of cells; empty if it ends before it starts.
struct Box {
    int low[2] = {kMostCells, kMostCells};
    int high[2] = {-1, -1};
    void add(int x, int y) {
        low[0] = std::min(low[0], x), high[0] = std::max(high[0], x);
        low[1] = std::min(low[1], y), high[1] = std::max(high[1], y);
    }
};

// Around the surface that connects with a cell, side by side.
Box flood(const PlaneGrid& grid, int x, int y, std::vector<char>& reached) {
    Box box;
    std::vector<std::pair<int, int>> queue;
    const auto visit = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= grid.width() || v >= grid.height()) return;
        if (reached[grid.index(u, v)] || grid.at(u, v).open()) return;
        reached[grid.index(u, v)] = 1;
        queue.emplace_back(u, v);
        if (grid.at(u, v).surface()) box.add(u, v);
    };
    visit(x, y);
    for (std::size_t head = 0; head < queue.size(); ++head) {
        const auto [u, v] = queue[head];
        visit(u - 1, v), visit(u + 1, v), visit(u, v - 1), visit(u, v + 1);
    }
    return box;
}

PlanePiece part_in(const PlanePiece& piece, const PlaneGrid& grid, const Box& box) {
    PlanePiece part = piece;
    part.indices.clear();
    Vec3d center = Vec3d::Zero();
    for (int axis = 0; axis < 2; ++axis) {
        const double start = grid.start(box.low[axis], axis);
        const double end = grid.start(box.high[axis] + 1, axis);
        center[axis] = 0.5 * (start + end);
        part.extents[axis] = end - start;
    }
    part.T_cloud_piece.translation() = piece.T_cloud_piece * center;
    return part;
}

}  // namespace

std::vector<PlanePiece> part_at_gaps(const PlanePiece& piece, const PointCloud& scan, double pitch,
                                     double slack) {
    const Vec3d to_eye =
        (scan.viewpoint.cast<double>() - piece.T_cloud_piece.translation()).normalized();
    const double slope = std::max(kMinSlope, std::abs(to_eye.dot(piece.normal)));
    if (!(pitch > 0.0)) return {piece};
    PlaneGrid grid(piece, kPixels * pitch / slope);
    trace(scan, piece, slack, grid);
    std::vector<char> reached(grid.index(0, grid.height()), 0);
    std::vector<PlanePiece> parts;
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            if (reached[grid.index(x, y)] || !grid.at(x, y).surface()) continue;
            parts.push_back(part_in(piece, grid, flood(grid, x, y, reached)));
        }
    }
    if (parts.size() < 2) return {piece};
    return parts;
}

}  // namespace ostraka
