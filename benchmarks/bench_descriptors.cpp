// SPDX-License-Identifier: Apache-2.0
// Descriptors and what they stand on (normals, clusters, registration) against their peers: one
// run, one thread, both sides in turn.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "benchmark.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "report.hpp"

namespace ostraka::bench {
namespace {

constexpr std::size_t kPoints = 6'000;

constexpr std::string_view kHelp =
    R"(Measures descriptors, normals, clusters and registration against PCL and Open3D.

usage: bench_descriptors [--only TEXT] [--cloud TEXT] [--seconds S] [--json FILE] [--data DIR]

  --only TEXT   only rows whose name or peer contains TEXT
  --cloud TEXT  only clouds whose name contains TEXT: bunny, uwa, part, batch
  --seconds S   time to spend on each row, at least 5 turns [1]
  --json FILE   also write the rows there
  --data DIR    the published data [environment variable OSTRAKA_DATA]

Both sides run in turn on one thread; each one's fastest run counts, in processor time. Each does
the whole job from the points (and normals, where a method takes them): search trees included.
Ratio: peer's time over ours. Rel. L1: sum of |ours - peer's| over the sum of |peer's|.
)";

struct Options {
    std::string only, cloud, json, data;
    double seconds = 1.0;
    bool help = false;
};

Options parse(int count, char** arguments) {
    Options options;
    if (const char* data = std::getenv("OSTRAKA_DATA")) options.data = data;
    for (int i = 1; i < count; ++i) {
        const std::string_view key = arguments[i];
        if (key == "--help" || key == "-h") {
            options.help = true;
            return options;
        }
        if (i + 1 == count) throw InvalidInput(fmt::format("{}: unknown, or without a value", key));
        const std::string value = arguments[++i];
        if (key == "--only") {
            options.only = value;
        } else if (key == "--cloud") {
            options.cloud = value;
        } else if (key == "--seconds") {
            options.seconds = std::atof(value.c_str());
        } else if (key == "--json") {
            options.json = value;
        } else if (key == "--data") {
            options.data = value;
        } else {
            throw InvalidInput(fmt::format("{}: unknown option, see --help", key));
        }
    }
    return options;
}

std::vector<Benchmark> single_thread_benchmarks() {
    std::vector<Benchmark> all;
    for (auto* list : {&pcl_geometry_benchmarks, &pcl_global_benchmarks, &pcl_regional_benchmarks,
                       &pcl_local_benchmarks, &open3d_benchmarks}) {
        for (Benchmark& benchmark : (*list)()) all.push_back(std::move(benchmark));
    }
    return all;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::vector<BenchCloud> clouds(const Options& options) {
    struct Source {
        std::string name;
        std::filesystem::path file;
    };
    const std::filesystem::path data = options.data;
    std::vector<BenchCloud> result;
    for (const Source& source : {Source{"bunny", data / "bologna/models/bunny.ply"},
                                 Source{"uwa", data / "uwa/models/chef.ply"},
                                 Source{"part", shipped_parts() / "pump_housing.ply"}}) {
        if (!contains(source.name, options.cloud)) continue;
        if (!std::filesystem::exists(source.file)) {
            fmt::print("{}: skipped, {} is not there (see --data)\n", source.name,
                       source.file.string());
            continue;
        }
        result.push_back(view_of(source.name, source.file, kPoints));
    }
    return result;
}

int run_all(const Options& options) {
    std::vector<Row> rows;
    const auto measure = [&](const std::vector<Benchmark>& benchmarks, const BenchCloud& cloud) {
        for (const Benchmark& benchmark : benchmarks) {
            if (!contains(benchmark.name + " " + benchmark.peer, options.only)) continue;
            rows.push_back(run(benchmark, cloud, options.seconds));
            print_row(stdout, rows.back());
        }
    };
    const std::vector<BenchCloud> views = clouds(options);
    print_head(stdout);
    set_thread_count(1);
    for (const BenchCloud& cloud : views) measure(single_thread_benchmarks(), cloud);
    set_thread_count(0);
    if (contains("batch", options.cloud) && contains("threads, 1 thread", options.only)) {
        measure(thread_benchmarks(), batch_of("batch", shipped_parts() / "pump_housing.ply"));
    }
    print_summary(stdout, rows);
    if (!options.json.empty()) write_json(options.json, rows);
    return 0;
}

}  // namespace
}  // namespace ostraka::bench

int main(int count, char** arguments) {
    try {
        const ostraka::bench::Options options = ostraka::bench::parse(count, arguments);
        if (options.help) {
            fmt::print("{}", ostraka::bench::kHelp);
            return 0;
        }
        return ostraka::bench::run_all(options);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_descriptors: {}\n", error.what());
        return 1;
    }
}
