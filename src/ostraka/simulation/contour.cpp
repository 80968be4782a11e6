// SPDX-License-Identifier: Apache-2.0
// Dual contouring. Departures from the paper, all to get a closed manifold without folds:
// - A cell has one vertex for each sheet of surface in it, not one (Schaefer, Ju, Warren. Manifold
//   Dual Contouring. IEEE TVCG 13(3), 2007, without the octree). On a face with four crossings
//   the inside corners are kept apart, by both cells alike.
// - Where two sheets join the same two vertices, both joints get a vertex of their own.
// - A vertex outside its cell is replaced by the best one inside (projected Gauss-Seidel).
// - A vertex on a smooth face is moved onto the surface; quads are split along the diagonal that
//   is nearer to the surface.
// - Where the surface still turns back on itself, vertices are drawn toward their crossings' mean.
#include "ostraka/simulation/contour.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/simulation/contour_grid.hpp"

namespace ostraka {
namespace {

// Around an edge along axis a, counter-clockwise seen from +a: cells at these steps along the
// next two axes.
constexpr std::array<std::array<int, 2>, 4> kAround = {{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};

// One crossing as seen by one of its four cells.
struct Side {
    std::uint64_t cell;      // linear index
    std::uint32_t crossing;  // into CrossingSet::crossings
    std::uint32_t around;    // into kAround
};

struct Surface {
    std::vector<Vec3d> vertices;
    std::vector<Vec3d> means;                           // of the crossings around each vertex
    std::vector<std::array<std::uint32_t, 4>> corners;  // of each crossing: vertices as in kAround
};

// The corner (3 bits) of a cell where an edge starts, for the cell at kAround[around].
int local_corner(int axis, std::uint32_t around) {
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    return (kAround[around][0] < 0 ? 1 << b : 0) | (kAround[around][1] < 0 ? 1 << c : 0);
}

int inside_corner(const Crossing& crossing, std::uint32_t around) {
    const int low = local_corner(crossing.axis, around);
    return crossing.low_inside ? low : low | 1 << crossing.axis;
}

std::vector<Side> sides_by_cell(const CrossingSet& set) {
    std::vector<Side> sides;
    sides.reserve(4 * set.crossings.size());
    const auto& cells = set.grid.cells;
    for (std::uint32_t i = 0; i < set.crossings.size(); ++i) {
        const Crossing& crossing = set.crossings[i];
        for (std::uint32_t around = 0; around < 4; ++around) {
            std::array<int, 3> at = crossing.corner;
            at[(crossing.axis + 1) % 3] += kAround[around][0];
            at[(crossing.axis + 2) % 3] += kAround[around][1];
            const std::uint64_t row = static_cast<std::uint64_t>(at[2]) * cells[1] + at[1];
            sides.push_back({row * cells[0] + at[0], i, around});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.cell, a.crossing) < std::tie(b.cell, b.crossing);
    });
    return sides;
}

// Numbers the sheets of a cell: crossings on the same face belong together, on a face with four
// only those at the same inside corner. Returns the sheet of each side.
std::array<int, 12> sheets_of(const CrossingSet& set, std::span<const Side> sides, int& count) {
    std::array<int, 12> sheet;
    for (int i = 0; i < 12; ++i) sheet[i] = i;
    const auto join = [&](int a, int b) {
        const int from = std::max(sheet[a], sheet[b]);
        const int to = std::min(sheet[a], sheet[b]);
        for (int& s : sheet) s = s == from ? to : s;
    };
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        std::array<int, 4> on_face{};
        int found = 0;
        for (int i = 0; i < static_cast<int>(sides.size()); ++i) {
            const int along = set.crossings[sides[i].crossing].axis;
            const int corner = local_corner(along, sides[i].around);
            if (along != axis && (corner >> axis & 1) == face % 2) on_face[found++] = i;
        }
        for (int i = 0; i < found; ++i) {
            for (int j = i + 1; j < found; ++j) {
                const Side& a = sides[on_face[i]];
                const Side& b = sides[on_face[j]];
                if (found == 2 || inside_corner(set.crossings[a.crossing], a.around) ==
                                      inside_corner(set.crossings[b.crossing], b.around)) {
                    join(on_face[i], on_face[j]);
                }
            }
        }
    }
    count = 0;
    std::array<int, 12> number;
    number.fill(-1);
    for (std::size_t i = 0; i < sides.size(); ++i) {
        if (number[sheet[i]] < 0) number[sheet[i]] = count++;
        sheet[i] = number[sheet[i]];
    }
    return sheet;
}

// The point of a cell with the least squared distance to the crossings' tangent planes; along
// directions that these leave open, the one nearest to the crossings' mean.
Vec3d place_vertex(const CrossingSet& set, std::span<const std::uint32_t> members,
                   const Vec3d& cell_low, double sharp_angle) {
    const double cell = set.grid.cell;
    Vec3d mean = Vec3d::Zero();
    Vec3d normal_sum = Vec3d::Zero();
    for (const std::uint32_t m : members) {
        mean += set.crossings[m].point;
        normal_sum += set.crossings[m].normal;
    }
    mean /= static_cast<double>(members.size());
    Eigen::Matrix3d ata = Eigen::Matrix3d::Zero();
    Eigen::Vector3d atb = Eigen::Vector3d::Zero();
    double least_cosine = 1.0;
    const Crossing& first = set.crossings[members[0]];
    for (const std::uint32_t m : members) {
        const Eigen::Vector3d n = set.crossings[m].normal;
        ata += n * n.transpose();
        atb += n * n.dot(set.crossings[m].point - mean);
        least_cosine = std::min(least_cosine, n.dot(first.normal));
    }
    const auto in_cell = [&](const Vec3d& p) {
        return (p - cell_low).minCoeff() >= 0.0 && (p - cell_low).maxCoeff() <= cell;
    };
    if (least_cosine > std::cos(sharp_angle)) {
        const Vec3d n = normal_sum.normalized();
        const Vec3d onto = mean - set.blocks[first.block].distance(mean) * n;
        return in_cell(onto) ? onto : mean;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(ata);
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    // Two planes at an angle t, one of them seen by one crossing in four: the eigenvalue is about
    // sin(t)^2 of the largest times 3/16; half of that still counts as an edge.
    const double floor = 0.09 * std::pow(std::sin(sharp_angle), 2) * eigen.eigenvalues()[2];
    for (int i = 0; i < 3; ++i) {
        if (eigen.eigenvalues()[i] < floor) continue;
        const Eigen::Vector3d v = eigen.eigenvectors().col(i);
        offset += v * (v.dot(atb) / eigen.eigenvalues()[i]);
    }
    if (in_cell(mean + offset)) return mean + offset;
    ata.diagonal().array() += 1e-3;
    offset.setZero();
    for (int sweep = 0; sweep < 40; ++sweep) {
        for (int i = 0; i < 3; ++i) {
            const double rest = ata.row(i).dot(offset) - ata(i, i) * offset[i];
            const double low = cell_low[i] - mean[i];
            offset[i] = std::clamp((atb[i] - rest) / ata(i, i), low, low + cell);
        }
    }
    return mean + offset;
}

// A vertex for each sheet of each cell.
Surface place_vertices(const CrossingSet& set, double sharp_angle) {
    const std::vector<Side> sides = sides_by_cell(set);
    Surface surface;
    surface.corners.resize(set.crossings.size());
    std::vector<std::vector<std::uint32_t>> members;  // of each vertex: its crossings
    std::vector<std::uint64_t> cell_of;               // of each vertex
    for (std::size_t begin = 0; begin < sides.size();) {
        std::size_t end = begin;
        while (end < sides.size() && sides[end].cell == sides[begin].cell) ++end;
        const std::span<const Side> here(sides.data() + begin, end - begin);
        int count = 0;
        const auto sheet = sheets_of(set, here, count);
        const auto base = static_cast<std::uint32_t>(members.size());
        members.resize(base + count);
        cell_of.resize(base + count, sides[begin].cell);
        for (std::size_t i = 0; i < here.size(); ++i) {
            members[base + sheet[i]].push_back(here[i].crossing);
            surface.corners[here[i].crossing][here[i].around] = base + sheet[i];
        }
        begin = end;
    }
    surface.vertices.resize(members.size());
    surface.means.resize(members.size());
    const auto& cells = set.grid.cells;
    parallel_for(
        members.size(),
        [&](std::size_t v) {
            const auto row = static_cast<int>(cell_of[v] / cells[0]);
            const Vec3d low = set.grid.corner(
                {static_cast<int>(cell_of[v] % cells[0]), row % cells[1], row / cells[1]});
            surface.vertices[v] = place_vertex(set, members[v], low, sharp_angle);
            Vec3d sum = Vec3d::Zero();
            for (const std::uint32_t m : members[v]) sum += set.crossings[m].point;
            surface.means[v] = sum / static_cast<double>(members[v].size());
        },
        1024);
    return surface;
}

// One joint of two neighboring cells' vertices: the face between them and, as two sheets can meet
// there, the inside corner that tells them apart.
using Joint = std::tuple<std::uint32_t, std::uint32_t, std::uint64_t>;

struct JointUse {
    Joint joint;
    std::uint32_t crossing;
    int side;  // from corner `side` to `side` + 1 around the crossing
    bool operator<(const JointUse& other) const {
        return std::tie(joint, crossing) < std::tie(other.joint, other.crossing);
    }
};

std::vector<JointUse> joints_of(const CrossingSet& set, const Surface& surface) {
    std::vector<JointUse> uses;
    uses.reserve(4 * surface.corners.size());
    const auto& cells = set.grid.cells;
    for (std::uint32_t i = 0; i < surface.corners.size(); ++i) {
        const Crossing& crossing = set.crossings[i];
        std::array<int, 3> at = crossing.corner;
        if (!crossing.low_inside) ++at[crossing.axis];
        const std::uint64_t inside =
            (static_cast<std::uint64_t>(at[2]) * (cells[1] + 1) + at[1]) * (cells[0] + 1) + at[0];
        for (int side = 0; side < 4; ++side) {
            const std::uint32_t a = surface.corners[i][side];
            const std::uint32_t b = surface.corners[i][(side + 1) % 4];
            uses.push_back({{std::min(a, b), std::max(a, b), inside}, i, side});
        }
    }
    std::sort(uses.begin(), uses.end());
    return uses;
}

// Adds a vertex on every joint whose two ends are joined twice.
// Returns (crossing, side) -> vertex for those.
std::map<std::pair<std::uint32_t, int>, std::uint32_t> split_double_joints(const CrossingSet& set,
                                                                           Surface& surface) {
    const std::vector<JointUse> uses = joints_of(set, surface);
    std::map<std::pair<std::uint32_t, int>, std::uint32_t> middle;
    for (std::size_t begin = 0; begin < uses.size();) {
        const auto ends = [&](std::size_t i) {
            return std::pair(std::get<0>(uses[i].joint), std::get<1>(uses[i].joint));
        };
        std::size_t end = begin;
        while (end < uses.size() && ends(end) == ends(begin)) ++end;
        for (std::size_t i = begin; end - begin > 2 && i + 1 < end; i += 2) {
            const auto vertex = static_cast<std::uint32_t>(surface.vertices.size());
            surface.vertices.push_back(0.5 * (set.crossings[uses[i].crossing].point +
                                              set.crossings[uses[i + 1].crossing].point));
            middle[{uses[i].crossing, uses[i].side}] = vertex;
            middle[{uses[i + 1].crossing, uses[i + 1].side}] = vertex;
        }
        begin = end;
    }
    return middle;
}

// Whether the diagonal from corner 0 to 2 is the better one.
bool first_diagonal(const Solid& solid, const std::array<Vec3d, 4>& p, double cell) {
    const Vec3d d02 = p[2] - p[0];
    const Vec3d d13 = p[3] - p[1];
    const Vec3d across = d02.cross(d13);
    const double bend = std::abs(across.normalized().dot(p[1] - p[0]));
    const bool shorter = d02.squaredNorm() <= d13.squaredNorm();
    if (!(bend > 1e-4 * cell)) {
        // Flat: only a diagonal inside the quad gives triangles of one orientation.
        const auto fits = [&](int a, int b, int c, int d) {
            const Vec3d one = (p[b] - p[a]).cross(p[c] - p[a]);
            const Vec3d two = (p[c] - p[a]).cross(p[d] - p[a]);
            return one.dot(two) > 0.0;
        };
        const bool first = fits(0, 1, 2, 3);
        const bool second = fits(1, 2, 3, 0);
        return first == second ? shorter : first;
    }
    const double off02 = std::abs(solid.distance(0.5 * (p[0] + p[2])));
    const double off13 = std::abs(solid.distance(0.5 * (p[1] + p[3])));
    return off02 == off13 ? shorter : off02 < off13;
}

TriangleMesh triangulate(const CrossingSet& set, Surface& surface) {
    const auto middle = split_double_joints(set, surface);
    TriangleMesh mesh;
    mesh.triangles.reserve(2 * surface.corners.size());
    const auto add = [&](bool forward, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        mesh.triangles.push_back(forward ? Triangle{a, b, c} : Triangle{a, c, b});
    };
    for (std::uint32_t i = 0; i < surface.corners.size(); ++i) {
        const Crossing& crossing = set.crossings[i];
        const auto& corner = surface.corners[i];
        std::vector<std::uint32_t> ring;
        for (int side = 0; side < 4; ++side) {
            ring.push_back(corner[side]);
            const auto extra = middle.find({i, side});
            if (extra != middle.end()) ring.push_back(extra->second);
        }
        if (ring.size() > 4) {
            const auto hub = static_cast<std::uint32_t>(surface.vertices.size());
            surface.vertices.push_back(crossing.point);
            for (std::size_t k = 0; k < ring.size(); ++k) {
                add(crossing.low_inside, hub, ring[k], ring[(k + 1) % ring.size()]);
            }
            continue;
        }
        std::array<Vec3d, 4> p;
        for (int k = 0; k < 4; ++k) p[k] = surface.vertices[corner[k]];
        const bool first = first_diagonal(set.blocks[crossing.block], p, set.grid.cell);
        const int s = first ? 0 : 1;
        add(crossing.low_inside, corner[s], corner[s + 1], corner[s + 2]);
        add(crossing.low_inside, corner[s], corner[s + 2], corner[(s + 3) % 4]);
    }
    return mesh;
}

// Where clamped vertices make neighboring triangles face each other, or a triangle has no area:
// draws their corners halfway toward the crossings' mean, a place that can't fold.
void unfold(const std::vector<Triangle>& triangles, Surface& surface) {
    constexpr int kRounds = 8;
    constexpr double kFoldCosine = -0.8;
    std::vector<std::array<std::uint32_t, 3>> edges;  // two vertices, triangle
    edges.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
            edges.push_back({low, high, t});
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<Vec3d> normals(triangles.size());
    for (int round = 0; round < kRounds; ++round) {
        const auto& p = surface.vertices;
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const auto& [a, b, c] = triangles[t];
            normals[t] = (p[b] - p[a]).cross(p[c] - p[a]).normalized();
        }
        std::vector<std::uint32_t> loose;
        for (std::size_t e = 0; e + 1 < edges.size(); e += 2) {
            const std::uint32_t s = edges[e][2];
            const std::uint32_t t = edges[e + 1][2];
            if (normals[s].dot(normals[t]) >= kFoldCosine && !normals[s].isZero(0.0) &&
                !normals[t].isZero(0.0)) {
                continue;
            }
            loose.insert(loose.end(), triangles[s].begin(), triangles[s].end());
            loose.insert(loose.end(), triangles[t].begin(), triangles[t].end());
        }
        if (loose.empty()) return;
        std::sort(loose.begin(), loose.end());
        loose.erase(std::unique(loose.begin(), loose.end()), loose.end());
        for (const std::uint32_t v : loose) {
            // Vertices on joints and hubs lie at crossings already.
            if (v >= surface.means.size()) continue;
            surface.vertices[v] = 0.5 * (surface.vertices[v] + surface.means[v]);
        }
    }
}

}  // namespace

TriangleMesh contour(const Solid& solid, const ContourSettings& settings) {
    if (!(settings.sharp_angle > 0.0) || settings.sharp_angle > 1.5) {
        throw InvalidInput("contour: the sharp angle must be above 0 and at most 1.5 radians");
    }
    const CrossingSet set = find_crossings(solid, settings.resolution);
    Surface surface = place_vertices(set, settings.sharp_angle);
    TriangleMesh mesh = triangulate(set, surface);
    unfold(mesh.triangles, surface);
    mesh.vertices.reserve(surface.vertices.size());
    for (const Vec3d& vertex : surface.vertices) mesh.vertices.push_back(vertex.cast<float>());
    return mesh;
}

}  // namespace ostraka
