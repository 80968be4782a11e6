// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/kdtree.hpp"

#include <algorithm>
#include <nanoflann.hpp>

namespace ostraka {
namespace {

struct Adaptor {
    std::span<const Vec3f> points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t dimension) const {
        return points[index][static_cast<Eigen::Index>(dimension)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
        return false;
    }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Adaptor>,
                                                  Adaptor, 3, std::uint32_t>;

bool closer(const Neighbor& a, const Neighbor& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                    : a.index < b.index;
}

// Keeps the k nearest as a max-heap ordered by (distance, index): ties don't depend on visit order.
class NearestSet {
  public:
    using DistanceType = float;

    NearestSet(std::size_t capacity, std::vector<Neighbor>& heap)
        : capacity_(capacity), heap_(heap) {
        heap_.clear();
    }
    bool full() const { return heap_.size() == capacity_; }
    float worstDist() const {
        return full() ? std::nextafter(heap_.front().squared_distance, kFar) : kFar;
    }
    bool addPoint(float squared_distance, std::uint32_t index) {
        const Neighbor candidate{index, squared_distance};
        if (!full()) {
            heap_.push_back(candidate);
            std::push_heap(heap_.begin(), heap_.end(), closer);
        } else if (closer(candidate, heap_.front())) {
            std::pop_heap(heap_.begin(), heap_.end(), closer);
            heap_.back() = candidate;
            std::push_heap(heap_.begin(), heap_.end(), closer);
        }
        return true;
    }

  private:
    static constexpr float kFar = std::numeric_limits<float>::max();
    std::size_t capacity_;
    std::vector<Neighbor>& heap_;
};

class WithinSet {
  public:
    using DistanceType = float;

    WithinSet(float squared_radius, std::vector<Neighbor>& found)
        : squared_radius_(squared_radius), found_(found) {
        found_.clear();
    }
    bool full() const { return true; }
    float worstDist() const { return squared_radius_; }
    bool addPoint(float squared_distance, std::uint32_t index) {
        if (squared_distance < squared_radius_) found_.push_back({index, squared_distance});
        return true;
    }

  private:
    float squared_radius_;
    std::vector<Neighbor>& found_;
};

}  // namespace

struct KdTree::Implementation {
    explicit Implementation(std::span<const Vec3f> points)
        : adaptor{points}, index(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
        // nanoflann 1.4 leaves building to the caller, 1.5 builds in its constructor; both accept
        // this.
        if (!points.empty()) index.buildIndex();
    }
    Adaptor adaptor;
    Index index;
};

KdTree::KdTree(std::span<const Vec3f> points)
    : implementation_(std::make_unique<Implementation>(points)) {}
KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;

std::size_t KdTree::size() const {
    return implementation_->adaptor.points.size();
}

Neighbor KdTree::nearest(const Vec3f& query) const {
    thread_local std::vector<Neighbor> neighbors;
    nearest(query, 1, neighbors);
    return neighbors.empty() ? Neighbor{} : neighbors.front();
}

void KdTree::nearest(const Vec3f& query, std::size_t k, std::vector<Neighbor>& neighbors) const {
    neighbors.clear();
    if (size() == 0 || k == 0) return;
    NearestSet result(std::min(k, size()), neighbors);
    implementation_->index.findNeighbors(result, query.data(), {});
    std::sort(neighbors.begin(), neighbors.end(), closer);
}

void KdTree::within(const Vec3f& query, float radius, std::vector<Neighbor>& neighbors) const {
    neighbors.clear();
    if (size() == 0) return;
    WithinSet result(radius * radius, neighbors);
    implementation_->index.findNeighbors(result, query.data(), {});
    std::sort(neighbors.begin(), neighbors.end(), closer);
}

}  // namespace ostraka
