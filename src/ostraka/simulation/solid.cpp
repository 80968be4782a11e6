// SPDX-License-Identifier: Apache-2.0
// The operations of CSG; the primitives are in solid_primitives.cpp.
#include <algorithm>
#include <limits>
#include <vector>

#include "ostraka/base/error.hpp"
#include "ostraka/simulation/solid_node.hpp"

namespace ostraka {
namespace {

using NodePtr = std::shared_ptr<const Solid::Node>;

// What a node is worth near a ball: the node to use there, and its value in the center.
struct Reduced {
    NodePtr node;
    double value;
};

Reduced reduce(const NodePtr& node, const Vec3d& center, double radius) {
    return {node->specialized(node, center, radius), node->distance(center)};
}

// Union and intersection. With a Lipschitz constant of 1 a child whose value in the center differs
// from the winner's by over 2 radius can't win anywhere in the ball.
template <bool kUnion>
struct Extreme final : Solid::Node {
    explicit Extreme(std::vector<NodePtr> nodes) : children(std::move(nodes)) {}

    double distance(const Vec3d& p) const override {
        double best = children.front()->distance(p);
        for (std::size_t i = 1; i < children.size(); ++i) {
            const double value = children[i]->distance(p);
            best = kUnion ? std::min(best, value) : std::max(best, value);
        }
        return best;
    }

    NodePtr specialized(const NodePtr& /*self*/, const Vec3d& center,
                        double radius) const override {
        std::vector<double> values;
        values.reserve(children.size());
        for (const NodePtr& child : children) {
            values.push_back((kUnion ? 1.0 : -1.0) * child->distance(center));
        }
        const double best = *std::min_element(values.begin(), values.end());
        std::vector<NodePtr> kept;
        for (std::size_t i = 0; i < children.size(); ++i) {
            if (values[i] > best + 2.0 * radius) continue;
            kept.push_back(children[i]->specialized(children[i], center, radius));
        }
        if (kept.size() == 1) return kept.front();
        return std::make_shared<Extreme>(std::move(kept));
    }

    std::vector<NodePtr> children;
};

struct Complement final : Solid::Node {
    explicit Complement(NodePtr node) : child(std::move(node)) {}
    double distance(const Vec3d& p) const override { return -child->distance(p); }
    NodePtr specialized(const NodePtr& self, const Vec3d& center, double radius) const override {
        NodePtr kept = child->specialized(child, center, radius);
        return kept == child ? self : std::make_shared<Complement>(std::move(kept));
    }
    NodePtr child;
};

struct SmoothUnion final : Solid::Node {
    SmoothUnion(NodePtr first, NodePtr second, double reach)
        : a(std::move(first)), b(std::move(second)), blend(reach) {}

    // The gradient is a convex combination of the children's, so the field stays Lipschitz.
    double distance(const Vec3d& p) const override {
        const double u = a->distance(p);
        const double v = b->distance(p);
        const double overlap = std::max(blend - std::abs(u - v), 0.0);
        return std::min(u, v) - overlap * overlap / (4.0 * blend);
    }

    NodePtr specialized(const NodePtr& /*self*/, const Vec3d& center,
                        double radius) const override {
        const Reduced u = reduce(a, center, radius);
        const Reduced v = reduce(b, center, radius);
        if (u.value - v.value > blend + 2.0 * radius) return v.node;
        if (v.value - u.value > blend + 2.0 * radius) return u.node;
        return std::make_shared<SmoothUnion>(u.node, v.node, blend);
    }

    NodePtr a;
    NodePtr b;
    double blend;
};

struct Grown final : Solid::Node {
    Grown(NodePtr node, double by) : child(std::move(node)), offset(by) {}
    double distance(const Vec3d& p) const override { return child->distance(p) - offset; }
    NodePtr specialized(const NodePtr& /*self*/, const Vec3d& center,
                        double radius) const override {
        return std::make_shared<Grown>(child->specialized(child, center, radius), offset);
    }
    NodePtr child;
    double offset;
};

struct Moved final : Solid::Node {
    Moved(NodePtr node, const Vec3d& by) : child(std::move(node)), translation(by) {}
    double distance(const Vec3d& p) const override { return child->distance(p - translation); }
    NodePtr specialized(const NodePtr& self, const Vec3d& center, double radius) const override {
        NodePtr kept = child->specialized(child, center - translation, radius);
        return kept == child ? self : std::make_shared<Moved>(std::move(kept), translation);
    }
    NodePtr child;
    Vec3d translation;
};

// A rotation or mirroring: child coordinates = matrix * own coordinates.
struct Turned final : Solid::Node {
    Turned(NodePtr node, const Mat3d& m) : child(std::move(node)), matrix(m) {}
    double distance(const Vec3d& p) const override { return child->distance(matrix * p); }
    NodePtr specialized(const NodePtr& self, const Vec3d& center, double radius) const override {
        NodePtr kept = child->specialized(child, matrix * center, radius);
        return kept == child ? self : std::make_shared<Turned>(std::move(kept), matrix);
    }
    NodePtr child;
    Mat3d matrix;
};

Bounds3 hull(const Bounds3& a, const Bounds3& b) {
    return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

// Bounds of the image under an orthogonal matrix (own = matrix^T * child).
Bounds3 turned_bounds(const Bounds3& bounds, const Mat3d& child_from_own) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (!bounds.low.allFinite() || !bounds.high.allFinite()) {
        return {Vec3d::Constant(-kInfinity), Vec3d::Constant(kInfinity)};
    }
    const Vec3d center = 0.5 * (bounds.low + bounds.high);
    const Vec3d half = 0.5 * (bounds.high - bounds.low);
    const Vec3d new_center = child_from_own.transpose() * center;
    const Vec3d new_half = child_from_own.transpose().cwiseAbs() * half;
    return {new_center - new_half, new_center + new_half};
}

Solid turned(const Solid& solid, const Mat3d& child_from_own) {
    return {std::make_shared<Turned>(solid.node(), child_from_own),
            turned_bounds(solid.bounds(), child_from_own)};
}

}  // namespace

Solid::Solid(std::shared_ptr<const Node> node, const Bounds3& bounds)
    : node_(std::move(node)), bounds_(bounds) {}

double Solid::distance(const Vec3d& point) const {
    return node_->distance(point);
}

Vec3d Solid::gradient(const Vec3d& point, double step) const {
    Vec3d slope;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d ahead = point;
        Vec3d behind = point;
        ahead[axis] += step;
        behind[axis] -= step;
        slope[axis] = node_->distance(ahead) - node_->distance(behind);
    }
    const double length = slope.norm();
    // On a medial surface the differences cancel; any direction is as good as another there.
    return length > 0.0 ? Vec3d(slope / length) : Vec3d(0.0, 0.0, 1.0);
}

Solid Solid::specialized(const Vec3d& center, double radius) const {
    // A rounding error must never drop a field that wins.
    const double safe_radius = radius * (1.0 + 1e-9) + 1e-9;
    return {node_->specialized(node_, center, safe_radius), bounds_};
}

Solid unite(std::span<const Solid> solids) {
    if (solids.empty()) throw InvalidInput("unite: no solids");
    std::vector<NodePtr> nodes;
    Bounds3 bounds = solids.front().bounds();
    for (const Solid& solid : solids) {
        nodes.push_back(solid.node());
        bounds = hull(bounds, solid.bounds());
    }
    if (nodes.size() == 1) return solids.front();
    return {std::make_shared<Extreme<true>>(std::move(nodes)), bounds};
}

Solid unite(std::initializer_list<Solid> solids) {
    return unite(std::span<const Solid>(solids.begin(), solids.size()));
}

Solid intersect(const Solid& a, const Solid& b) {
    const Bounds3 bounds{a.bounds().low.cwiseMax(b.bounds().low),
                         a.bounds().high.cwiseMin(b.bounds().high)};
    return {std::make_shared<Extreme<false>>(std::vector<NodePtr>{a.node(), b.node()}), bounds};
}

Solid subtract(const Solid& a, const Solid& b) {
    std::vector<NodePtr> nodes{a.node(), std::make_shared<Complement>(b.node())};
    return {std::make_shared<Extreme<false>>(std::move(nodes)), a.bounds()};
}

Solid smooth_unite(const Solid& a, const Solid& b, double blend) {
    require_positive(blend, "blend of a smooth union");
    Bounds3 bounds = hull(a.bounds(), b.bounds());
    // The polynomial lowers the field by at most blend / 4.
    bounds.low.array() -= 0.25 * blend;
    bounds.high.array() += 0.25 * blend;
    return {std::make_shared<SmoothUnion>(a.node(), b.node(), blend), bounds};
}

Solid grown(const Solid& solid, double offset) {
    if (!(offset >= 0.0) || !std::isfinite(offset)) {
        throw InvalidInput("grown: the offset must be at least 0");
    }
    Bounds3 bounds = solid.bounds();
    bounds.low.array() -= offset;
    bounds.high.array() += offset;
    return {std::make_shared<Grown>(solid.node(), offset), bounds};
}

Solid moved(const Solid& solid, const Vec3d& translation) {
    return {std::make_shared<Moved>(solid.node(), translation),
            Bounds3{solid.bounds().low + translation, solid.bounds().high + translation}};
}

Solid rotated(const Solid& solid, const Vec3d& axis, double angle) {
    const double length = axis.norm();
    require_positive(length, "length of a rotation axis");
    const Eigen::Vector3d unit = axis / length;
    return turned(solid, Eigen::AngleAxisd(-angle, unit).toRotationMatrix());
}

Solid with_mirror(const Solid& solid, int axis) {
    if (axis < 0 || axis > 2) throw InvalidInput("with_mirror: the axis must be 0, 1 or 2");
    Mat3d flip = Mat3d::Identity();
    flip(axis, axis) = -1.0;
    return unite({solid, turned(solid, flip)});
}

Solid circular(const Solid& solid, int count) {
    if (count < 1) throw InvalidInput("circular: the count must be at least 1");
    std::vector<Solid> copies{solid};
    for (int i = 1; i < count; ++i) {
        copies.push_back(rotated(solid, Vec3d::UnitZ(), 2.0 * kPi * i / count));
    }
    return unite(copies);
}

}  // namespace ostraka
