// SPDX-License-Identifier: Apache-2.0
// Approximate search of many descriptor rows: ours, hnswlib's and faiss', on the same rows.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>

#include "index_methods.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/descriptors/metric.hpp"
#include "ostraka/library/neighbor_graph.hpp"

namespace ostraka::bench {
namespace {

constexpr std::size_t kNearest = 10;
constexpr double kRecallGoal = 0.99;
constexpr int kRepeats = 3;                // of all queries; the fastest counts
constexpr std::size_t kQueriesAtOnce = 8;  // compared with a row while it is at hand

constexpr std::string_view kHelp =
    R"(Searches global SHOT rows of generated parts approximately: ours, hnswlib, faiss.

usage: bench_index [--rows N] [--queries N] [--cache FILE] [--threads N] [--only TEXT] [--json FILE]

  --rows N       rows searched; a million take half an hour to make [100000]
  --queries N    at most so many, of other viewpoints and cuts than the rows [1000]
  --cache FILE   rows are read from there, or made and left there
  --threads N    for making and building; searches take one [all cores]
  --only TEXT    only methods whose name contains TEXT
  --json FILE    also write the rows there

Recall@10 is counted against an exact search, of the float rows and of the rows in 8 bits; a row as
near as the tenth is right. Time is processor time of one thread, the fastest of three runs.
)";

struct Options {
    std::size_t rows = 100'000;
    std::size_t queries = 1'000;
    std::string cache, only, json;
    int threads = 0;
    bool help = false;
};

// The distance of the tenth nearest row of each query.
struct Truth {
    std::vector<float> as_floats;
    std::vector<std::int32_t> as_bytes;
};

struct Setting {
    int breadth = 0;
    double float_recall = 0.0;
    double byte_recall = 0.0;
    double milliseconds = 0.0;
};

// The library's rows and the queries in 8 bits.
struct ByteSide {
    std::vector<std::uint8_t> library;
    std::vector<std::uint8_t> queries;
    std::size_t length = 0;
    ByteScale scale;
    ByteRows rows() const { return {library, length}; }
    std::span<const std::uint8_t> query(std::size_t i) const {
        return std::span(queries).subspan(i * length, length);
    }
};

Options parse(int count, char** arguments) {
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string_view key = arguments[i];
        if (key == "--help" || key == "-h") {
            options.help = true;
            return options;
        }
        if (i + 1 == count) throw InvalidInput(fmt::format("{}: unknown, or without a value", key));
        const std::string value = arguments[++i];
        if (key == "--rows") {
            options.rows = std::stoul(value);
        } else if (key == "--queries") {
            options.queries = std::stoul(value);
        } else if (key == "--cache") {
            options.cache = value;
        } else if (key == "--threads") {
            options.threads = std::stoi(value);
        } else if (key == "--only") {
            options.only = value;
        } else if (key == "--json") {
            options.json = value;
        } else {
            throw InvalidInput(fmt::format("{}: unknown option, see --help", key));
        }
    }
    if (options.rows < kNearest) throw InvalidInput("at least 10 rows are searched");
    return options;
}

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

float float_distance(const IndexRows& rows, std::size_t row, std::size_t query) {
    return distance(rows.row(row), rows.query(query), Metric::l2);
}

std::vector<float> exact_float_distances(const IndexRows& rows) {
    std::vector<float> tenth(rows.query_count());
    const std::size_t jobs = (tenth.size() + kQueriesAtOnce - 1) / kQueriesAtOnce;
    parallel_for(jobs, [&](std::size_t job) {
        const std::size_t first = job * kQueriesAtOnce;
        const std::size_t last = std::min(tenth.size(), first + kQueriesAtOnce);
        std::vector<std::vector<float>> nearest(last - first);
        for (std::size_t row = 0; row < rows.size(); ++row) {
            for (std::size_t q = first; q < last; ++q) {
                std::vector<float>& heap = nearest[q - first];
                heap.push_back(float_distance(rows, row, q));
                std::push_heap(heap.begin(), heap.end());
                if (heap.size() <= kNearest) continue;
                std::pop_heap(heap.begin(), heap.end());
                heap.pop_back();
            }
        }
        for (std::size_t q = first; q < last; ++q) tenth[q] = nearest[q - first].front();
    });
    return tenth;
}

Truth exact_truth(const IndexRows& rows, const ByteSide& bytes) {
    Truth truth;
    truth.as_floats = exact_float_distances(rows);
    double found = 0.0;
    const double before = processor_seconds();
    for (std::size_t q = 0; q < rows.query_count(); ++q) {
        const auto matches = exact_nearest(bytes.rows(), bytes.query(q), kNearest);
        truth.as_bytes.push_back(matches.back().distance);
        for (const RowMatch& match : matches) {
            found += float_distance(rows, match.row, q) <= truth.as_floats[q] ? 1.0 : 0.0;
        }
    }
    const auto queries = static_cast<double>(rows.query_count());
    fmt::print("exact search in 8 bits: recall {:.4f} against floats, {:.2f} ms a query\n",
               found / (queries * kNearest), (processor_seconds() - before) * 1e3 / queries);
    return truth;
}

// A file that holds rows and graph, written and read back: what loading a library costs.
void measure_loading(const ByteSide& bytes, const NeighborGraph& graph) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       fmt::format("bench_index_{}.bin", std::time(nullptr));
    const auto size_of = [](const auto& v) {
        return static_cast<std::streamsize>(v.size() * sizeof(v[0]));
    };
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.library.data()), size_of(bytes.library));
    out.write(reinterpret_cast<const char*>(graph.links.data()), size_of(graph.links));
    out.close();
    const Stopwatch watch;
    std::vector<std::uint8_t> rows(bytes.library.size());
    NeighborGraph read{.degree = graph.degree, .start = graph.start};
    read.links.resize(graph.links.size());
    std::ifstream in(path, std::ios::binary);
    in.read(reinterpret_cast<char*>(rows.data()), size_of(rows));
    in.read(reinterpret_cast<char*>(read.links.data()), size_of(read.links));
    check_graph(read, bytes.rows().size());
    fmt::print("  read from a file and checked: {:.2f} s\n", watch.seconds());
    std::filesystem::remove(path);
}

// Leaves the k matches that are nearest to the query before it was rounded.
void refine(const IndexRows& rows, const ByteSide& bytes, std::size_t query,
            std::vector<RowMatch>& matches, std::size_t k) {
    const std::vector<float> distances =
        decoded_distances(bytes.rows(), bytes.scale, rows.query(query), matches);
    std::vector<std::pair<float, std::uint32_t>> order;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        order.emplace_back(distances[i], matches[i].row);
    }
    std::sort(order.begin(), order.end());
    matches.resize(std::min(k, matches.size()));
    for (std::size_t i = 0; i < matches.size(); ++i) matches[i].row = order[i].second;
}

std::vector<SearchMethod> our_methods(const IndexRows& rows, const ByteSide& bytes) {
    const auto graph = std::make_shared<NeighborGraph>();
    const auto scratch = std::make_shared<SearchScratch>();
    std::vector<SearchMethod> methods;
    for (const bool refined : {false, true}) {
        SearchMethod method{.name = refined ? "ours, the same graph, refined" : "ours"};
        method.breadths = {10, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};
        method.build = [=, &bytes] {
            if (graph->degree > 0) return;
            *graph = build_neighbor_graph(bytes.rows());
            measure_loading(bytes, *graph);
        };
        method.bytes = [=, &bytes] {
            return bytes.library.size() + graph->links.size() * sizeof(graph->links[0]);
        };
        method.search = [=, &rows, &bytes](std::size_t query, std::size_t k, int breadth,
                                           std::uint32_t* found) {
            const auto wide = static_cast<std::size_t>(breadth);
            const auto span = search_graph(*graph, bytes.rows(), bytes.query(query),
                                           refined ? wide : k, wide, *scratch);
            std::vector<RowMatch> matches(span.begin(), span.end());
            if (refined) refine(rows, bytes, query, matches, k);
            for (std::size_t i = 0; i < matches.size(); ++i) found[i] = matches[i].row;
        };
        methods.push_back(method);
    }
    return methods;
}

Setting measure(const SearchMethod& method, int breadth, const IndexRows& rows,
                const ByteSide& bytes, const Truth& truth) {
    const std::size_t queries = rows.query_count();
    std::vector<std::uint32_t> found(queries * kNearest, kNoIndex);
    Setting setting{.breadth = breadth, .milliseconds = 1e9};
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
        const double before = processor_seconds();
        for (std::size_t q = 0; q < queries; ++q) {
            method.search(q, kNearest, breadth, found.data() + q * kNearest);
        }
        const double each = (processor_seconds() - before) * 1e3 / static_cast<double>(queries);
        setting.milliseconds = std::min(setting.milliseconds, each);
    }
    const double share = 1.0 / static_cast<double>(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i] >= rows.size()) continue;
        const std::size_t q = i / kNearest;
        const std::uint8_t* row = bytes.rows().row(found[i]).data();
        const std::int32_t distance = squared_distance(row, bytes.query(q).data(), bytes.length);
        if (distance <= truth.as_bytes[q]) setting.byte_recall += share;
        if (float_distance(rows, found[i], q) <= truth.as_floats[q]) setting.float_recall += share;
    }
    return setting;
}

nlohmann::json run(const SearchMethod& method, const Options& options, const IndexRows& rows,
                   const ByteSide& bytes, const Truth& truth) {
    fmt::print("{}\n", method.name);
    set_thread_count(options.threads);
    Stopwatch watch;
    method.build();
    const double seconds = watch.seconds();
    set_thread_count(1);
    fmt::print("  built in {:.1f} s; {:.1f} MiB to search\n", seconds,
               static_cast<double>(method.bytes()) / (1 << 20));
    fmt::print("  breadth  recall: floats   bytes   ms a query\n");
    nlohmann::json settings;
    for (const int breadth : method.breadths) {
        const Setting s = measure(method, breadth, rows, bytes, truth);
        fmt::print("  {:7d} {:15.4f} {:7.4f} {:12.4f}\n", breadth, s.float_recall, s.byte_recall,
                   s.milliseconds);
        std::fflush(stdout);
        settings.push_back({{"breadth", breadth},
                            {"float_recall", s.float_recall},
                            {"byte_recall", s.byte_recall},
                            {"ms", s.milliseconds}});
        if (std::max(s.float_recall, s.byte_recall) >= 0.5 + 0.5 * kRecallGoal) break;
    }
    return {{"name", method.name},
            {"build_s", seconds},
            {"bytes", method.bytes()},
            {"settings", settings}};
}

int run_all(const Options& options) {
    set_thread_count(options.threads);
    const IndexRows rows = index_rows(options.rows, options.queries, options.cache);
    ByteSide bytes{.length = rows.length};
    bytes.scale = choose_scale(rows.library);
    bytes.library = quantize(rows.library, bytes.scale);
    bytes.queries = quantize(rows.queries, bytes.scale);
    fmt::print("{} rows of {}, {} queries, k {}\n", rows.size(), rows.length, rows.query_count(),
               kNearest);
    const Truth truth = exact_truth(rows, bytes);
    std::vector<SearchMethod> methods = our_methods(rows, bytes);
    const int cores = static_cast<int>(std::thread::hardware_concurrency());
    const int threads = options.threads > 0 ? options.threads : std::max(1, cores);
    for (const auto& [name, peers] : {std::pair{"hnswlib", hnswlib_methods(rows)},
                                      std::pair{"faiss", faiss_methods(rows, threads)}}) {
        if (peers.empty()) fmt::print("{}: skipped, it was not found\n", name);
        methods.insert(methods.end(), peers.begin(), peers.end());
    }
    nlohmann::json results;
    for (SearchMethod& method : methods) {
        if (method.name.find(options.only) == std::string::npos) continue;
        results.push_back(run(method, options, rows, bytes, truth));
        method = {};  // its index is freed
    }
    if (options.json.empty()) return 0;
    std::ofstream file(options.json);
    file << results.dump(1) << '\n';
    if (!file.flush()) throw FileError(options.json, "can't be written");
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
        fmt::print(stderr, "bench_index: {}\n", error.what());
        return 1;
    }
}
