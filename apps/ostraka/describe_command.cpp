// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "describe_chart.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/cloud_file.hpp"

namespace ostraka::app {
namespace {

constexpr std::size_t kDrawn = 3;  // rows in a picture, if none are asked for

struct DescribeOptions {
    CommonOptions common;
    std::string cloud;
    std::string descriptor;
    std::string viewpoint;
    std::string csv;
    std::string image;
    std::string draw;
    double sampling = 0.0;
    float radius = 0.0F;
};

// Everything about a piece's rows that the outputs show.
struct Described {
    PointCloud piece;
    AnyDescriptor descriptor;
    std::vector<float> rows;
    RegionalDescriptors regional;  // of a regional descriptor, without its rows

    std::size_t length() const { return descriptor_length(descriptor); }
    std::size_t count() const { return rows.size() / length(); }
    DescriptorKind kind() const { return descriptor_kind(descriptor); }
    std::span<const float> row(std::size_t r) const {
        return std::span(rows).subspan(r * length(), length());
    }
};

std::string all_names() {
    std::string names;
    for (const AnyDescriptor& descriptor : all_descriptors()) {
        names += fmt::format("{}{}", names.empty() ? "" : ", ", descriptor_name(descriptor));
    }
    return names;
}

PointCloud load_piece(const DescribeOptions& options) {
    PointCloud cloud = read_cloud_file(options.cloud).cloud;
    if (const auto viewpoint = parse_viewpoint(options.viewpoint)) cloud.viewpoint = *viewpoint;
    cloud = remove_invalid(cloud);
    if (options.sampling > 0.0) {
        cloud.normals.clear();
        cloud = resample(cloud, options.sampling);
        cloud.normals = estimate_normals_within(cloud, kNormalRadius * options.sampling);
    } else if (cloud.normals.empty()) {
        cloud.normals = estimate_normals(cloud);
    }
    return remove_invalid(cloud);
}

AnyDescriptor chosen_descriptor(const DescribeOptions& options) {
    const auto found = parse_descriptor(options.descriptor);
    if (!found) {
        throw CLI::ValidationError("--descriptor", fmt::format("there is no {}; there are {}",
                                                               options.descriptor, all_names()));
    }
    AnyDescriptor descriptor = *found;
    if (options.radius == 0.0F) return descriptor;
    if (descriptor_kind(descriptor) != DescriptorKind::local) {
        throw CLI::ValidationError(
            "--radius", fmt::format("{} has no radius: it describes the piece, not points",
                                    options.descriptor));
    }
    std::visit(
        [&](auto& settings) {
            if constexpr (requires { settings.radius; }) settings.radius = options.radius;
        },
        descriptor);
    return descriptor;
}

Described describe_piece(const DescribeOptions& options) {
    const AnyDescriptor descriptor = chosen_descriptor(options);
    Described result{load_piece(options), descriptor, {}, {}};
    if (result.kind() != DescriptorKind::regional) {
        result.rows = describe(result.piece, result.descriptor);
        return result;
    }
    if (const auto* settings = std::get_if<CvfhSettings>(&result.descriptor)) {
        result.regional = describe_cvfh(result.piece, *settings);
    } else {
        result.regional =
            describe_our_cvfh(result.piece, std::get<OurCvfhSettings>(result.descriptor));
    }
    result.rows = std::move(result.regional.rows);
    return result;
}

Json numbers(const Vec3f& v) {
    return {v.x(), v.y(), v.z()};
}

Json row_json(const Described& described, std::size_t r) {
    Json row;
    if (described.kind() == DescriptorKind::local)
        row["point"] = numbers(described.piece.points[r]);
    if (described.kind() == DescriptorKind::regional) {
        const std::uint32_t region = described.regional.region_of_row[r];
        row["region"] = region == kNoIndex ? Json(nullptr) : Json(region);
        if (!described.regional.T_frame_cloud.empty() && region != kNoIndex) {
            row["T_frame_cloud"] = pose_json(described.regional.T_frame_cloud[r]);
        }
    }
    row["values"] = described.row(r);
    return row;
}

Json to_json(const Described& described) {
    Json json = {{"descriptor", descriptor_name(described.descriptor)},
                 {"kind", descriptor_kind_name(described.kind())},
                 {"points", described.piece.size()},
                 {"length", described.length()}};
    if (described.kind() == DescriptorKind::regional) {
        json["regions"] = Json::array();
        for (const SmoothRegion& region : described.regional.regions) {
            json["regions"].push_back({{"points", region.points.size()},
                                       {"centroid", numbers(region.centroid)},
                                       {"normal", numbers(region.normal)}});
        }
    }
    json["rows"] = Json::array();
    for (std::size_t r = 0; r < described.count(); ++r)
        json["rows"].push_back(row_json(described, r));
    return json;
}

// One line a row; local ones begin with their point.
std::string to_csv(const Described& described) {
    const bool local = described.kind() == DescriptorKind::local;
    std::string text = local ? "x,y,z" : "row";
    for (std::size_t k = 0; k < described.length(); ++k) text += fmt::format(",{}", k);
    text += '\n';
    for (std::size_t r = 0; r < described.count(); ++r) {
        const Vec3f& p = described.piece.points[local ? r : 0];
        text += local ? fmt::format("{},{},{}", p.x(), p.y(), p.z()) : std::to_string(r);
        for (const float value : described.row(r)) text += fmt::format(",{}", value);
        text += '\n';
    }
    return text;
}

void write_csv(const std::string& text, const std::string& path) {
    if (path.empty()) return;
    if (path != "-") return write_file_atomically(path, text);
    std::cout << text << std::flush;
    if (!std::cout) throw FileError("standard output", "can't be written");
}

// Points far from each other: the first far from the middle, each other far from those before.
std::vector<std::size_t> spread_points(const PointCloud& piece, std::size_t count) {
    std::vector<std::size_t> chosen;
    std::vector<double> nearest(piece.size(), 1e300);
    Vec3d from = centroid(piece.points);
    while (chosen.size() < std::min(count, piece.size())) {
        std::size_t farthest = 0;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const double distance = (piece.points[i].cast<double>() - from).squaredNorm();
            nearest[i] = chosen.empty() ? distance : std::min(nearest[i], distance);
            if (nearest[i] > nearest[farthest]) farthest = i;
        }
        if (chosen.empty()) nearest.assign(piece.size(), 1e300);
        chosen.push_back(farthest);
        from = piece.points[farthest].cast<double>();
    }
    return chosen;
}

std::vector<std::size_t> rows_to_draw(const Described& described, const std::string& asked) {
    std::vector<std::size_t> rows;
    if (!asked.empty()) {
        for (const double number : parse_numbers(asked, "--draw")) {
            if (!(number >= 0.0 && number < double(described.count())) ||
                number != std::floor(number)) {
                throw CLI::ValidationError(
                    "--draw", fmt::format("there is no row {}: rows are 0 to {}", number,
                                          described.count() - 1));
            }
            rows.push_back(static_cast<std::size_t>(number));
        }
        return rows;
    }
    if (described.kind() == DescriptorKind::local) return spread_points(described.piece, kDrawn);
    // Of each region the first row: further frames change its octants only.
    for (std::size_t r = 0; r < described.count() && rows.size() < kDrawn; ++r) {
        const auto& regions = described.regional.region_of_row;
        if (r == 0 || regions.empty() || regions[r] != regions[r - 1]) rows.push_back(r);
    }
    return rows;
}

ChartRow chart_row(const Described& described, std::size_t r) {
    const std::span<const float> values = described.row(r);
    ChartRow row{{values.begin(), values.end()}, "", {}, false};
    if (described.kind() == DescriptorKind::local) {
        row.caption = fmt::format("point {}", r);
        row.points = {static_cast<std::uint32_t>(r)};
        row.marked = true;
    }
    if (described.kind() == DescriptorKind::regional) {
        const std::uint32_t region = described.regional.region_of_row[r];
        if (region == kNoIndex) return row;
        row.points = described.regional.regions[region].points;
        row.caption = fmt::format("row {}: region {}, {} points", r, region, row.points.size());
    }
    return row;
}

void write_picture(const Described& described, const DescribeOptions& options) {
    if (options.image.empty()) return;
    std::vector<ChartRow> rows;
    for (const std::size_t r : rows_to_draw(described, options.draw)) {
        rows.push_back(chart_row(described, r));
    }
    const std::string title =
        fmt::format("{} of {}: {} {} of {} numbers", descriptor_name(described.descriptor),
                    std::filesystem::path(options.cloud).stem().string(), described.count(),
                    described.count() == 1 ? "row" : "rows", described.length());
    write_png(options.image,
              draw_chart(title, described.piece, chart_blocks(described.descriptor), rows));
}

void run_describe(const DescribeOptions& options) {
    const Described described = describe_piece(options);
    write_picture(described, options);
    write_csv(to_csv(described), options.csv);
    write_json(to_json(described), options.common.json);
    say(fmt::format("{}: {} points, {} {} of {} numbers ({})", options.cloud,
                    described.piece.size(), described.count(),
                    described.count() == 1 ? "row" : "rows", described.length(),
                    descriptor_kind_name(described.kind())));
}

}  // namespace

void add_describe(CLI::App& app) {
    auto options = std::make_shared<DescribeOptions>();
    CLI::App* command = app.add_subcommand(
        "describe",
        "show what a descriptor makes of a piece of surface, as numbers and as a picture\n"
        "  ostraka views flange.ply -o views --views 20\n"
        "  ostraka describe views/flange_0003.pcd --descriptor our_cvfh --image row.png --csv -");
    command->add_option("cloud", options->cloud, "the piece: PLY, PCD, XYZ or TXT")->required();
    command
        ->add_option("--descriptor", options->descriptor,
                     "one row for the piece: vfh, esf, gasd, shot, rops, gasd_color; one for each "
                     "smooth region: cvfh, our_cvfh; one for each point: shot_local, rops_local, "
                     "pfh, fpfh, spin_image")
        ->required();
    command->add_option("--csv", options->csv,
                        "write the rows, one a line, to a file, or to standard output with -");
    command->add_option("--image", options->image,
                        "draw the piece and its rows as bars into a PNG file; their heights are "
                        "square roots, which is how rows are compared");
    command->add_option("--draw", options->draw,
                        "rows to draw, as 0,3,8 (default: those of the 3 largest "
                        "regions, or of 3 points far apart)");
    command->add_option("--sampling", options->sampling,
                        "bring the piece to this distance between points, in the file's unit, and "
                        "compute its normals anew (default: take the piece as it is)");
    command->add_option("--radius", options->radius,
                        "of the support of local descriptors, in the file's unit (default: 15 mean "
                        "distances between points)");
    add_viewpoint(*command, options->viewpoint);
    add_common(*command, options->common);
    command->callback([options] { run_describe(*options); });
}

}  // namespace ostraka::app
