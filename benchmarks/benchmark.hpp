// SPDX-License-Identifier: Apache-2.0
// Methods registered by name, each against a peer that does the same job in the same run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clouds.hpp"

namespace ostraka::bench {

/// One of the two that compete.
struct Side {
    std::function<void()> run;                   ///< does the whole job once; this is timed
    std::function<std::vector<float>()> answer;  ///< what the last run gave, to compare with
};

struct Contest {
    Side ours;
    Side peer;
    std::function<std::string()> note = {};  ///< what the numbers don't say, after the runs
};

struct Benchmark {
    std::string name;
    std::string peer;      ///< "PCL 1.13", ...
    double goal = 0.0;     ///< ratio peer / ours that is aimed at; 0: none
    bool in_mean = false;  ///< counts in the geometric mean against PCL
    bool wall = false;     ///< timed by the wall clock: where threads share the work
    std::function<Contest(const BenchCloud&)> prepare;  ///< untimed
};

struct Row {
    std::string name, cloud, peer;
    std::size_t points = 0;
    double ours_ms = 0.0;
    double peer_ms = 0.0;
    double ratio = 0.0;   ///< peer / ours
    double goal = 0.0;    ///< 0: none
    double rel_l1 = 0.0;  ///< sum |ours - peer| / sum |peer|; < 0: not comparable
    bool in_mean = false;
    std::string note;
};

/// Runs both sides in turn and takes each one's fastest run: a busy machine only ever adds time.
/// @param seconds  time to spend; at least 5 turns are made. Five times as long where the wall
/// clock
///                 is read.
Row run(const Benchmark& benchmark, const BenchCloud& cloud, double seconds);

/// @return -1 if the lengths differ or the peer's answer is all 0.
double relative_l1(const std::vector<float>& ours, const std::vector<float>& peer);

// One list a file; a list is empty where its peer was not found when the program was built.
std::vector<Benchmark> pcl_geometry_benchmarks();
std::vector<Benchmark> pcl_global_benchmarks();
std::vector<Benchmark> pcl_regional_benchmarks();
std::vector<Benchmark> pcl_local_benchmarks();
std::vector<Benchmark> open3d_benchmarks();
std::vector<Benchmark> thread_benchmarks();

}  // namespace ostraka::bench
