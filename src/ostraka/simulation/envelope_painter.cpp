// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/envelope_painter.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kBlock = 128;  // edges or triangles at once
constexpr std::int32_t kSpare = 16;  // notes at the end of each sheet that count for nothing

template <typename T>
using Column = std::array<T, kBlock>;
using CornerColumns = std::array<Column<float>, 3>;  // x, y, z

// Of each node (column, row) of the grid, what is in a cell or on one of its borders: the lowest
// and, negated, the highest height, so that both are minima.
struct Sheet {
    std::vector<float> heights;

    void note(std::int32_t node, float z) {
        float* at = heights.data() + 2 * static_cast<std::size_t>(node);
        at[0] = std::min(at[0], z);
        at[1] = std::min(at[1], -z);
    }
};

// What a block's items note: one note each, on spare nodes where there is none. An item that meets
// two lines of the grid on an axis is visited again for the line before the last; one that meets
// more than kMaxLines is painted by itself, and has no notes here.
struct BlockNotes {
    Column<std::int32_t> node;
    Column<float> z;
    Column<std::int32_t> lines;  // that the item meets, on the axis where these are most
};
constexpr std::int32_t kMaxLines = 2;

// Where edges cross a line on which the coordinate "main" is whole.
struct EdgeColumns {
    const float* main[2];
    const float* other[2];
    const float* z[2];
};
// @param before  0: the last line that an edge meets, 1: the one before.
OSTRAKA_VECTOR_CLONES void crossings(const EdgeColumns& edges, std::int32_t before,
                                     std::int32_t main_stride, std::int32_t other_stride,
                                     std::int32_t spare, BlockNotes& notes) {
    for (std::size_t k = 0; k < kBlock; ++k) {
        const float from = edges.main[0][k];
        const float to = edges.main[1][k];
        const auto first = static_cast<std::int32_t>(from);
        const auto last = static_cast<std::int32_t>(to);
        const std::int32_t highest = first > last ? first : last;
        const std::int32_t lines = highest - (first > last ? last : first);
        const std::int32_t line = highest - before;
        const bool meets = (lines > before) & (lines <= kMaxLines);
        const float t = meets ? (static_cast<float>(line) - from) / (to - from) : 0.0F;
        const float a = edges.other[0][k];
        const float b = edges.other[1][k];
        const float low = a < b ? a : b;
        const float high = a < b ? b : a;
        float at = a + t * (b - a);
        at = at < low ? low : at;
        at = at > high ? high : at;
        const std::int32_t node = line * main_stride + static_cast<std::int32_t>(at) * other_stride;
        notes.node[k] = meets ? node : spare + static_cast<std::int32_t>(k % kSpare);
        notes.z[k] = edges.z[0][k] + t * (edges.z[1][k] - edges.z[0][k]);
        notes.lines[k] = lines;
    }
}

// The cells that triangles reach along one axis.
struct Reach {
    Column<std::int32_t> last;
    Column<std::int32_t> lines;  // of the grid that are crossed
};
OSTRAKA_VECTOR_CLONES void reach_along(const Column<float>& a, const Column<float>& b,
                                       const Column<float>& c, Reach& reach) {
    for (std::size_t k = 0; k < kBlock; ++k) {
        const float ab_low = a[k] < b[k] ? a[k] : b[k];
        const float ab_high = a[k] < b[k] ? b[k] : a[k];
        const float low = ab_low < c[k] ? ab_low : c[k];
        const float high = ab_high < c[k] ? c[k] : ab_high;
        reach.last[k] = static_cast<std::int32_t>(high);
        reach.lines[k] = reach.last[k] - static_cast<std::int32_t>(low);
    }
}

// A corner of cells that may be under each triangle.
// @param before_x, before_y  0: on the last line that a triangle meets, 1: on the one before.
OSTRAKA_VECTOR_CLONES void corners(const std::array<CornerColumns, 3>& triangles,
                                   const Reach& along_x, const Reach& along_y,
                                   std::int32_t before_x, std::int32_t before_y,
                                   std::int32_t stride, std::int32_t spare, BlockNotes& notes) {
    const auto& [a, b, c] = triangles;
    for (std::size_t k = 0; k < kBlock; ++k) {
        const std::int32_t column = along_x.last[k] - before_x;
        const std::int32_t row = along_y.last[k] - before_y;
        const auto x = static_cast<float>(column);
        const auto y = static_cast<float>(row);
        const float ax = a[0][k] - x;
        const float ay = a[1][k] - y;
        const float bx = b[0][k] - x;
        const float by = b[1][k] - y;
        const float cx = c[0][k] - x;
        const float cy = c[1][k] - y;
        // Twice the areas that the corner spans with the edges: its barycentric coordinates.
        const float wa = bx * cy - by * cx;
        const float wb = cx * ay - cy * ax;
        const float wc = ax * by - ay * bx;
        const float sum = wa + wb + wc;
        // Without branches: inside if all have one sign.
        const float ab_least = wa < wb ? wa : wb;
        const float ab_most = wa < wb ? wb : wa;
        const float least = ab_least < wc ? ab_least : wc;
        const float most = ab_most < wc ? wc : ab_most;
        const std::int32_t columns = along_x.lines[k];
        const std::int32_t rows = along_y.lines[k];
        const std::int32_t most_lines = columns > rows ? columns : rows;
        const bool under = ((least >= 0.0F) | (most <= 0.0F)) & (sum != 0.0F) &
                           (columns > before_x) & (rows > before_y) & (most_lines <= kMaxLines);
        notes.z[k] = (wa * a[2][k] + wb * b[2][k] + wc * c[2][k]) / (under ? sum : 1.0F);
        notes.node[k] =
            under ? row * stride + column : spare + static_cast<std::int32_t>(k % kSpare);
        notes.lines[k] = (columns > 0) & (rows > 0) ? most_lines : 0;
    }
}

// The least of each cell's note and those on two opposite borders, [i] and [i + step].
OSTRAKA_VECTOR_CLONES void gather(const float* borders, std::size_t count, std::size_t step,
                                  float* cells) {
    for (std::size_t i = 0; i < count; ++i) {
        const float near = borders[i];
        const float far = borders[i + step];
        const float least = near < far ? near : far;
        cells[i] = cells[i] < least ? cells[i] : least;
    }
}

class Painter {
  public:
    Painter(const GridVertices& vertices, const HeightMap& map)
        : vertices_(vertices), stride_(map.stride), nodes_(map.stride * (map.rows + 1)) {
        for (Sheet* sheet : {&cells_, &lines_x_, &lines_y_, &corners_}) {
            sheet->heights.assign(2 * static_cast<std::size_t>(nodes_ + kSpare), kInfinity);
        }
    }

    void paint_vertices() {
        for (std::size_t i = 0; i < vertices_.x.size(); ++i) {
            const auto column = static_cast<std::int32_t>(vertices_.x[i]);
            const auto row = static_cast<std::int32_t>(vertices_.y[i]);
            const std::int32_t node = row * stride_ + column;
            cells_.note(node, vertices_.z[i]);
            // In the middle of four cells, of which edges that end there note three.
            if (vertices_.x[i] == static_cast<float>(column) &&
                vertices_.y[i] == static_cast<float>(row) && column > 0) {
                corners_.note(node, vertices_.z[i]);
            }
        }
    }

    void paint_edges(std::span<const MeshEdge> edges) {
        std::vector<MeshEdge> more_x;
        std::vector<MeshEdge> more_y;
        for_blocks(edges, ends_, [&](std::span<const MeshEdge> block) {
            note_edges<0>(block, 0);
            collect(block, more_x);
            note_edges<1>(block, 0);
            collect(block, more_y);
        });
        paint_more<0>(more_x);
        paint_more<1>(more_y);
    }

    void paint_triangles(std::span<const Triangle> triangles) {
        std::vector<Triangle> more;
        for_blocks(triangles, corners_of_, [&](std::span<const Triangle> block) {
            reach_triangles();
            note_triangles(block, 0, 0);
            collect(block, more);
        });
        for_blocks(std::span<const Triangle>(more), corners_of_,
                   [&](std::span<const Triangle> block) {
                       reach_triangles();
                       for (const auto& [x, y] : {std::pair{0, 1}, {1, 0}, {1, 1}}) {
                           note_triangles(block, x, y);
                       }
                       for (std::size_t k = 0; k < block.size(); ++k) {
                           if (notes_.lines[k] > kMaxLines) large_triangle(block[k]);
                       }
                   });
    }

    void finish(HeightMap& map) {
        const auto row = 2 * static_cast<std::size_t>(stride_);
        const std::size_t count = row * static_cast<std::size_t>(map.rows);
        // A corner is shared by two lines, and so by four cells.
        gather(corners_.heights.data(), count, row, lines_x_.heights.data());
        gather(lines_x_.heights.data(), count, 2, cells_.heights.data());
        gather(lines_y_.heights.data(), count, row, cells_.heights.data());
        map.low.resize(count / 2);
        map.high.resize(count / 2);
        for (std::size_t i = 0; i < count / 2; ++i) {
            map.low[i] = cells_.heights[2 * i];
            map.high[i] = -cells_.heights[2 * i + 1];
        }
    }

  private:
    struct Crossing {
        float x;
        float z;
    };

    Vec3f vertex(std::uint32_t v) const { return {vertices_.x[v], vertices_.y[v], vertices_.z[v]}; }

    // Calls body(block) with the corners of the block's edges or triangles loaded into columns. The
    // rest of the last block keeps what it had and is not used.
    template <typename Item, std::size_t Corners, typename Body>
    void for_blocks(std::span<const Item> items, std::array<CornerColumns, Corners>& columns,
                    const Body& body) const {
        for (std::size_t begin = 0; begin < items.size(); begin += kBlock) {
            const auto block = items.subspan(begin, std::min(kBlock, items.size() - begin));
            for (std::size_t k = 0; k < block.size(); ++k) {
                for (std::size_t corner = 0; corner < Corners; ++corner) {
                    const std::uint32_t v = block[k][corner];
                    columns[corner][0][k] = vertices_.x[v];
                    columns[corner][1][k] = vertices_.y[v];
                    columns[corner][2][k] = vertices_.z[v];
                }
            }
            body(block);
        }
    }

    // Keeps what must be visited again; without a branch that nobody could predict.
    template <typename Item>
    void collect(std::span<const Item> block, std::vector<Item>& more) const {
        std::size_t count = more.size();
        more.resize(count + block.size());
        for (std::size_t k = 0; k < block.size(); ++k) {
            more[count] = block[k];
            count += notes_.lines[k] > 1 ? 1 : 0;
        }
        more.resize(count);
    }

    template <int Axis>
    Sheet& lines() {
        return Axis == 0 ? lines_x_ : lines_y_;
    }

    template <int Axis>
    void note_edges(std::span<const MeshEdge> block, std::int32_t before) {
        constexpr std::size_t kOther = 1 - Axis;
        const auto& [p, q] = ends_;
        const EdgeColumns edges{{p[Axis].data(), q[Axis].data()},
                                {p[kOther].data(), q[kOther].data()},
                                {p[2].data(), q[2].data()}};
        const std::int32_t main_stride = Axis == 0 ? 1 : stride_;
        const std::int32_t other_stride = Axis == 0 ? stride_ : 1;
        crossings(edges, before, main_stride, other_stride, nodes_, notes_);
        for (std::size_t k = 0; k < block.size(); ++k) {
            lines<Axis>().note(notes_.node[k], notes_.z[k]);
        }
    }

    // Edges that meet more than one line.
    template <int Axis>
    void paint_more(std::span<const MeshEdge> edges) {
        for_blocks(edges, ends_, [&](std::span<const MeshEdge> block) {
            note_edges<Axis>(block, 1);
            for (std::size_t k = 0; k < block.size(); ++k) {
                if (notes_.lines[k] <= kMaxLines) continue;
                long_edge<Axis>(vertex(block[k][0]), vertex(block[k][1]));
            }
        });
    }

    void reach_triangles() {
        const auto& [a, b, c] = corners_of_;
        reach_along(a[0], b[0], c[0], reach_x_);
        reach_along(a[1], b[1], c[1], reach_y_);
    }

    void note_triangles(std::span<const Triangle> block, std::int32_t before_x,
                        std::int32_t before_y) {
        corners(corners_of_, reach_x_, reach_y_, before_x, before_y, stride_, nodes_, notes_);
        for (std::size_t k = 0; k < block.size(); ++k) {
            corners_.note(notes_.node[k], notes_.z[k]);
        }
    }

    // Where an edge crosses lines of the grid on which coordinate Axis is whole.
    template <int Axis>
    void long_edge(const Vec3f& p, const Vec3f& q) {
        constexpr int kOther = 1 - Axis;
        const Vec3f& from = p[Axis] < q[Axis] ? p : q;
        const Vec3f& to = p[Axis] < q[Axis] ? q : p;
        const auto [low, high] = std::minmax(p[kOther], q[kOther]);
        const auto last = static_cast<std::int32_t>(to[Axis]);
        for (auto line = static_cast<std::int32_t>(from[Axis]) + 1; line <= last; ++line) {
            const float t = (static_cast<float>(line) - from[Axis]) / (to[Axis] - from[Axis]);
            const float other = from[kOther] + t * (to[kOther] - from[kOther]);
            const auto at = static_cast<std::int32_t>(std::clamp(other, low, high));
            const float z = from.z() + t * (to.z() - from.z());
            lines<Axis>().note(Axis == 0 ? at * stride_ + line : line * stride_ + at, z);
        }
    }

    static Crossing along(const Vec3f& p, const Vec3f& q, float y) {
        const float t = (y - p.y()) / (q.y() - p.y());
        return {p.x() + t * (q.x() - p.x()), p.z() + t * (q.z() - p.z())};
    }

    // The corners of cells under a triangle, line by line.
    void large_triangle(const Triangle& corners) {
        std::array<Vec3f, 3> p = {vertex(corners[0]), vertex(corners[1]), vertex(corners[2])};
        std::sort(p.begin(), p.end(), [](const Vec3f& a, const Vec3f& b) { return a.y() < b.y(); });
        const auto last = static_cast<std::int32_t>(p[2].y());
        for (auto line = static_cast<std::int32_t>(p[0].y()) + 1; line <= last; ++line) {
            const auto y = static_cast<float>(line);
            const bool upper = p[1].y() < y;  // of the two shorter edges
            Crossing from = along(p[0], p[2], y);
            Crossing to = upper ? along(p[1], p[2], y) : along(p[0], p[1], y);
            if (from.x > to.x) std::swap(from, to);
            const float length = to.x - from.x;
            const auto end = static_cast<std::int32_t>(to.x);
            // Rounded up; the standard function takes long without SSE 4. What is on line 0, the
            // map's border, is noted by edges.
            const auto before = static_cast<std::int32_t>(from.x);
            const std::int32_t ahead_of = static_cast<float>(before) < from.x ? 1 : 0;
            const std::int32_t start = std::max(before + ahead_of, 1);
            for (std::int32_t column = start; column <= end; ++column) {
                const float ahead = static_cast<float>(column) - from.x;
                const float t = length > 0.0F ? ahead / length : 0.0F;
                corners_.note(line * stride_ + column, from.z + t * (to.z - from.z));
            }
        }
    }

    const GridVertices& vertices_;
    std::int32_t stride_;
    std::int32_t nodes_;
    Sheet cells_;
    Sheet lines_x_;  // between cells (column - 1, row) and (column, row)
    Sheet lines_y_;  // between cells (column, row - 1) and (column, row)
    Sheet corners_;  // of cells (column - 1, row - 1) to (column, row)
    // Of the block at hand.
    std::array<CornerColumns, 2> ends_{};
    std::array<CornerColumns, 3> corners_of_{};
    Reach reach_x_{};
    Reach reach_y_{};
    BlockNotes notes_{};
};

}  // namespace

void paint(const RasterMesh& mesh, const GridVertices& vertices, HeightMap& map) {
    Painter painter(vertices, map);
    painter.paint_vertices();
    painter.paint_edges(mesh.edges);
    painter.paint_triangles(mesh.triangles);
    painter.finish(map);
}

}  // namespace ostraka
