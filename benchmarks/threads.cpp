// SPDX-License-Identifier: Apache-2.0
// A batch of 200 pieces on two threads against the same on one.
#include <memory>

#include "benchmark.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/descriptors/descriptor.hpp"

namespace ostraka::bench {
namespace {

using Describe = std::function<std::vector<float>(const PointCloud&)>;

std::vector<float> describe_all(const std::vector<PointCloud>& pieces, const Describe& describe) {
    std::vector<std::vector<float>> rows(pieces.size());
    parallel_for(pieces.size(), [&](std::size_t i) { rows[i] = describe(pieces[i]); });
    std::vector<float> all;
    for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
    return all;
}

Benchmark batch(const std::string& name, const Describe& describe) {
    struct State {
        std::vector<float> two, one;
    };
    const auto prepare = [describe](const BenchCloud& cloud) -> Contest {
        auto state = std::make_shared<State>();
        const auto run = [state, describe, &cloud](int threads, std::vector<float> State::*rows) {
            set_thread_count(threads);
            (*state).*rows = describe_all(cloud.pieces, describe);
            set_thread_count(0);
        };
        return {{[run] { run(2, &State::two); }, [state] { return state->two; }},
                {[run] { run(1, &State::one); }, [state] { return state->one; }}};
    };
    return {.name = "two threads, " + name,
            .peer = "one thread",
            .goal = 1.7,
            .wall = true,
            .prepare = prepare};
}

std::vector<float> normals_of(const PointCloud& piece) {
    std::vector<float> flat;
    for (const Vec3f& n : estimate_normals(piece)) {
        flat.insert(flat.end(), {n.x(), n.y(), n.z()});
    }
    return flat;
}

}  // namespace

std::vector<Benchmark> thread_benchmarks() {
    std::vector<Benchmark> list;
    for (const AnyDescriptor& descriptor :
         {AnyDescriptor(VfhSettings{}), AnyDescriptor(EsfSettings{}), AnyDescriptor(GasdSettings{}),
          AnyDescriptor(GlobalShotSettings{}), AnyDescriptor(GlobalRopsSettings{})}) {
        list.push_back(
            batch(std::string(descriptor_name(descriptor)),
                  [descriptor](const PointCloud& piece) { return describe(piece, descriptor); }));
    }
    list.push_back(batch("normals", normals_of));
    return list;
}

}  // namespace ostraka::bench
