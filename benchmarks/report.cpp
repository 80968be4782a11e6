// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ostraka/base/error.hpp"

namespace ostraka::bench {

void print_head(std::FILE* file) {
    fmt::print(file, "{:<26} {:<8} {:>7} {:>10} {:<12} {:>10} {:>7} {:>6} {:>9}\n", "name", "cloud",
               "points", "ours ms", "peer", "peer ms", "ratio", "goal", "rel. L1");
    std::fflush(file);
}

void print_row(std::FILE* file, const Row& row) {
    const std::string goal = row.goal > 0.0 ? fmt::format("{:.3g}", row.goal) : "-";
    const std::string l1 = row.rel_l1 >= 0.0 ? fmt::format("{:.1e}", row.rel_l1) : "-";
    const char* verdict = row.ratio < row.goal ? "  below" : "";
    fmt::print(file, "{:<26} {:<8} {:>7} {:>10.3f} {:<12} {:>10.3f} {:>7.1f} {:>6} {:>9}{}{}\n",
               row.name, row.cloud, row.points, row.ours_ms, row.peer, row.peer_ms, row.ratio, goal,
               l1, verdict, row.note.empty() ? "" : "  " + row.note);
    std::fflush(file);
}

void print_summary(std::FILE* file, const std::vector<Row>& rows) {
    double logs = 0.0;
    int counted = 0;
    int with_goal = 0;
    int reached = 0;
    for (const Row& row : rows) {
        if (row.in_mean) {
            logs += std::log(row.ratio);
            ++counted;
        }
        if (row.goal > 0.0) {
            ++with_goal;
            if (row.ratio >= row.goal) ++reached;
        }
    }
    if (counted > 0) {
        fmt::print(file,
                   "\ngeometric mean of the {} rows with a goal against PCL: {:.1f} (goal 12)\n",
                   counted, std::exp(logs / counted));
    }
    fmt::print(file, "goals reached: {} of {}\n", reached, with_goal);
}

void write_json(const std::filesystem::path& path, const std::vector<Row>& rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
        nlohmann::ordered_json entry;
        entry["name"] = row.name;
        entry["cloud"] = row.cloud;
        entry["points"] = row.points;
        entry["ours_ms"] = row.ours_ms;
        entry["peer"] = row.peer;
        entry["peer_ms"] = row.peer_ms;
        entry["ratio"] = row.ratio;
        entry["goal"] = row.goal > 0.0 ? nlohmann::ordered_json(row.goal) : nullptr;
        entry["rel_l1"] = row.rel_l1 >= 0.0 ? nlohmann::ordered_json(row.rel_l1) : nullptr;
        if (!row.note.empty()) entry["note"] = row.note;
        list.push_back(std::move(entry));
    }
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path);
    file << list.dump(1) << '\n';
    if (!file.flush()) throw FileError(path, "can't be written");
}

}  // namespace ostraka::bench
