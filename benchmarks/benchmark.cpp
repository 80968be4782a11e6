// SPDX-License-Identifier: Apache-2.0
#include "benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "ostraka/base/stopwatch.hpp"

namespace ostraka::bench {
namespace {

constexpr int kLeastTurns = 5;
constexpr int kMostTurns = 400;

// A single thread's processor time does not grow while other programs run; the wall clock's does.
double now_ms(bool wall) {
    timespec time{};
    clock_gettime(wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double timed(const Side& side, bool wall) {
    const double start = now_ms(wall);
    side.run();
    return now_ms(wall) - start;
}

}  // namespace

double relative_l1(const std::vector<float>& ours, const std::vector<float>& peer) {
    if (ours.size() != peer.size()) return -1.0;
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        if (!std::isfinite(peer[i])) continue;  // PCL's mark for "undefined"
        difference += std::abs(double{ours[i]} - double{peer[i]});
        size += std::abs(double{peer[i]});
    }
    return size > 0.0 ? difference / size : -1.0;
}

Row run(const Benchmark& benchmark, const BenchCloud& cloud, double seconds) {
    const Contest contest = benchmark.prepare(cloud);
    Row row{.name = benchmark.name, .cloud = cloud.name, .peer = benchmark.peer};
    row.points = cloud.cloud.size();
    for (const PointCloud& piece : cloud.pieces) row.points += piece.size();
    row.ours_ms = row.peer_ms = std::numeric_limits<double>::max();
    if (benchmark.wall) seconds *= 5.0;
    const Stopwatch watch;
    for (int turn = 0; turn < kMostTurns; ++turn) {
        if (turn >= kLeastTurns && watch.seconds() > seconds) break;
        row.ours_ms = std::min(row.ours_ms, timed(contest.ours, benchmark.wall));
        row.peer_ms = std::min(row.peer_ms, timed(contest.peer, benchmark.wall));
    }
    row.ratio = row.peer_ms / row.ours_ms;
    row.goal = benchmark.goal;
    row.in_mean = benchmark.in_mean;
    row.rel_l1 = relative_l1(contest.ours.answer(), contest.peer.answer());
    if (contest.note) row.note = contest.note();
    return row;
}

}  // namespace ostraka::bench
