// SPDX-License-Identifier: Apache-2.0
// Greg Turk. The PLY Polygon File Format. 1994.
#include "ostraka/io/ply.hpp"

#include <cmath>
#include <limits>

#include "ostraka/io/ply_header.hpp"
#include "ostraka/io/ply_source.hpp"

namespace ostraka {
namespace {

enum class Wanted { Mesh, Cloud };

struct PlyContent {
    PlyHeader header;
    std::vector<Vec3f> points;
    std::vector<Vec3f> normals;
    std::vector<Color> colors;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> grid;  // the vertex in each cell of range_grid, or kNoIndex
};

// Where a vertex's property goes: slots 0-2 position, 3-5 normal, 6-8 color.
constexpr int kSlots = 9;
constexpr std::array<std::array<const char*, 2>, kSlots> kSlotNames = {{{"x", "x"},
                                                                        {"y", "y"},
                                                                        {"z", "z"},
                                                                        {"nx", "normal_x"},
                                                                        {"ny", "normal_y"},
                                                                        {"nz", "normal_z"},
                                                                        {"red", "diffuse_red"},
                                                                        {"green", "diffuse_green"},
                                                                        {"blue", "diffuse_blue"}}};

struct VertexLayout {
    std::vector<int> slots;  // of each property; -1 if it is skipped
    bool has_points = false;
    bool has_normals = false;
    bool has_colors = false;
    PlyType color_type = PlyType::Uint8;
};

VertexLayout make_layout(const PlyElement& element) {
    VertexLayout layout;
    layout.slots.assign(element.properties.size(), -1);
    std::array<bool, kSlots> found = {};
    for (int slot = 0; slot < kSlots; ++slot) {
        const int property = element.find(kSlotNames[static_cast<std::size_t>(slot)]);
        if (property < 0 || element.properties[static_cast<std::size_t>(property)].is_list) {
            continue;
        }
        layout.slots[static_cast<std::size_t>(property)] = slot;
        found[static_cast<std::size_t>(slot)] = true;
        if (slot == kSlots - 1) {
            layout.color_type = element.properties[static_cast<std::size_t>(property)].type;
        }
    }
    layout.has_points = found[0] && found[1] && found[2];
    layout.has_normals = found[3] && found[4] && found[5];
    layout.has_colors = found[6] && found[7] && found[8];
    return layout;
}

std::uint8_t to_color(double value, PlyType type) {
    if (type == PlyType::Float32 || type == PlyType::Float64) {
        value = std::round(value * 255.0);
    } else if (type == PlyType::Uint16 || type == PlyType::Int16) {
        value = std::floor(value / 257.0);
    }
    return value > 0.0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : std::uint8_t{0};
}

Vec3f to_vector(const double* values) {
    return Vec3d(values[0], values[1], values[2]).cast<float>();
}

template <class Source>
void skip_property(Source& source, const PlyProperty& property) {
    std::int64_t length = 1;
    if (property.is_list) {
        length = source.integer(property.count_type);
        if (length < 0) {
            source.fail("negative list length");
        }
    }
    source.skip(property.type, static_cast<std::uint64_t>(length));
}

// Reads a list of vertex indices into `list` (replaced).
template <class Source>
void read_indices(Source& source, const PlyProperty& property, std::uint64_t vertex_count,
                  std::vector<std::uint32_t>& list) {
    const std::int64_t length = source.integer(property.count_type);
    if (length < 0) {
        source.fail("negative list length");
    }
    source.require(static_cast<std::uint64_t>(length), property.type);
    list.clear();
    for (std::int64_t i = 0; i < length; ++i) {
        const std::int64_t index = source.integer(property.type);
        if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count) {
            source.fail(fmt::format("names vertex {}, but there are {}", index, vertex_count));
        }
        list.push_back(static_cast<std::uint32_t>(index));
    }
}

template <class Source>
void read_vertices(Source& source, const PlyElement& element, Wanted wanted, PlyContent& content) {
    const VertexLayout layout = make_layout(element);
    if (!layout.has_points) {
        source.fail("element \"vertex\" lacks x, y or z");
    }
    const bool normals = wanted == Wanted::Cloud && layout.has_normals;
    const bool colors = wanted == Wanted::Cloud && layout.has_colors;
    content.points.reserve(element.count);
    content.normals.reserve(normals ? element.count : 0);
    content.colors.reserve(colors ? element.count : 0);
    std::array<double, kSlots> row = {};
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            if (layout.slots[p] < 0) {
                skip_property(source, element.properties[p]);
            } else {
                row[static_cast<std::size_t>(layout.slots[p])] =
                    source.number(element.properties[p].type);
            }
        }
        content.points.push_back(to_vector(row.data()));
        if (normals) {
            content.normals.push_back(to_vector(row.data() + 3));
        }
        if (colors) {
            content.colors.push_back({to_color(row[6], layout.color_type),
                                      to_color(row[7], layout.color_type),
                                      to_color(row[8], layout.color_type)});
        }
    }
}

constexpr std::array<const char*, 2> kIndexLists = {"vertex_indices", "vertex_index"};

// Calls use(list) with the vertex indices of each item; the other properties are skipped.
template <class Source, class Use>
void read_index_lists(Source& source, const PlyElement& element, std::uint64_t vertex_count,
                      Use use) {
    const int wanted = element.find(kIndexLists);
    std::vector<std::uint32_t> list;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            if (static_cast<int>(p) == wanted && property.is_list) {
                read_indices(source, property, vertex_count, list);
                use(list);
            } else {
                skip_property(source, property);
            }
        }
    }
}

template <class Source>
void skip_element(Source& source, const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (const PlyProperty& property : element.properties) {
            skip_property(source, property);
        }
    }
}

template <class Source>
void read_body(Source source, Wanted wanted, PlyContent& content) {
    std::uint64_t vertex_count = 0;
    for (const PlyElement& element : content.header.elements) {
        vertex_count = element.name == "vertex" ? element.count : vertex_count;
    }
    if (vertex_count >= kNoIndex) {
        source.fail("more vertices than 32 bits can count");
    }
    for (const PlyElement& element : content.header.elements) {
        if (element.name == "vertex") {
            read_vertices(source, element, wanted, content);
        } else if (element.name == "face" && wanted == Wanted::Mesh) {
            content.triangles.reserve(element.count);
            read_index_lists(source, element, vertex_count,
                             [&](const auto& polygon) { append_fan(polygon, content.triangles); });
        } else if (element.name == "range_grid" && wanted == Wanted::Cloud) {
            read_index_lists(source, element, vertex_count, [&](const auto& cell) {
                content.grid.push_back(cell.empty() ? kNoIndex : cell.front());
            });
        } else {
            skip_element(source, element);
        }
    }
}

PlyContent parse_ply(std::span<const char> bytes, const std::filesystem::path& path,
                     Wanted wanted) {
    PlyContent content;
    content.header = parse_ply_header(bytes, path);
    constexpr std::array<const char*, 1> kX = {"x"};
    const bool has_vertices =
        std::any_of(content.header.elements.begin(), content.header.elements.end(),
                    [&](const auto& e) { return e.name == "vertex" && e.find(kX) >= 0; });
    if (!has_vertices) {
        throw FormatError(path, "header", "no element \"vertex\" with x, y, z");
    }
    if (content.header.format == PlyFormat::Ascii) {
        read_body(PlyAsciiSource(bytes, content.header, path), wanted, content);
    } else {
        read_body(PlyBinarySource(bytes, content.header, path), wanted, content);
    }
    return content;
}

// The numbers after the last note that begins with `name`.
std::vector<double> find_note(const PlyHeader& header, std::string_view name) {
    std::vector<double> numbers;
    for (std::string_view note : header.notes) {
        if (next_word(note) != name) {
            continue;
        }
        numbers.clear();
        double number = 0.0;
        while (parse_number(next_word(note), number)) {
            numbers.push_back(number);
        }
    }
    return numbers;
}

// A count of columns or rows; 0 if the notes state none.
int find_size(const PlyHeader& header, std::string_view name) {
    const std::vector<double> numbers = find_note(header, name);
    const bool valid = numbers.size() == 1 && numbers[0] >= 1.0 &&
                       numbers[0] <= std::numeric_limits<int>::max() &&
                       numbers[0] == std::floor(numbers[0]);
    return valid ? static_cast<int>(numbers[0]) : 0;
}

void set_grid(PointCloud& cloud, int width, int height) {
    if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) == cloud.size()) {
        cloud.width = width;
        cloud.height = height;
    }
}

// One item for each cell; cells without a vertex get `none`.
template <class Item>
void spread(std::vector<Item>& items, const std::vector<std::uint32_t>& grid, const Item& none) {
    if (items.empty()) {
        return;
    }
    std::vector<Item> spread_items;
    spread_items.reserve(grid.size());
    for (const std::uint32_t vertex : grid) {
        spread_items.push_back(vertex == kNoIndex ? none : items[vertex]);
    }
    items = std::move(spread_items);
}

// Stanford's range scans store only the returns, and for each cell which of them it holds.
void apply_range_grid(const std::vector<std::uint32_t>& grid, const PlyHeader& header,
                      PointCloud& cloud) {
    const int width = find_size(header, "num_cols");
    const int height = find_size(header, "num_rows");
    const auto cells = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    if (grid.empty() || cells != grid.size() || cloud.empty()) {
        return;
    }
    const Vec3f none = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
    spread(cloud.points, grid, none);
    spread(cloud.normals, grid, none);
    spread(cloud.colors, grid, Color{});
    set_grid(cloud, width, height);
}

std::string ply_header(const std::string& comments) {
    return "ply\nformat binary_little_endian 1.0\n" + comments;
}

std::string cloud_comments(const PointCloud& cloud) {
    std::string comments;
    if (cloud.organized()) {
        comments += fmt::format("comment width {}\ncomment height {}\n", cloud.width, cloud.height);
    }
    if (!cloud.viewpoint.isZero(0.0F)) {
        comments += "comment viewpoint";
        for (const float coordinate : cloud.viewpoint) {
            comments += ' ';
            append_number(comments, coordinate);
        }
        comments += '\n';
    }
    return comments;
}

}  // namespace

TriangleMesh parse_ply_mesh(std::span<const char> bytes, const std::filesystem::path& path) {
    PlyContent content = parse_ply(bytes, path, Wanted::Mesh);
    return {std::move(content.points), std::move(content.triangles)};
}

CloudFile parse_ply_cloud(std::span<const char> bytes, const std::filesystem::path& path) {
    PlyContent content = parse_ply(bytes, path, Wanted::Cloud);
    CloudFile file;
    file.cloud.points = std::move(content.points);
    file.cloud.normals = std::move(content.normals);
    file.cloud.colors = std::move(content.colors);
    if (content.grid.empty()) {
        set_grid(file.cloud, find_size(content.header, "width"),
                 find_size(content.header, "height"));
    } else {
        apply_range_grid(content.grid, content.header, file.cloud);
    }
    const std::vector<double> viewpoint = find_note(content.header, "viewpoint");
    if (viewpoint.size() == 3) {
        const Vec3f position = to_vector(viewpoint.data());
        file.has_viewpoint = position.allFinite() && !position.isZero(0.0F);
        file.cloud.viewpoint = file.has_viewpoint ? position : Vec3f::Zero();
    }
    return file;
}

std::string encode_ply(const TriangleMesh& mesh) {
    constexpr std::size_t kVertexSize = 12;
    constexpr std::size_t kFaceSize = 13;
    std::string bytes = ply_header(
        fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                    mesh.vertices.size(), mesh.triangles.size()));
    bytes.reserve(bytes.size() + kVertexSize * mesh.vertices.size() +
                  kFaceSize * mesh.triangles.size());
    for (const Vec3f& vertex : mesh.vertices) {
        append_little(bytes, vertex);
    }
    for (const Triangle& triangle : mesh.triangles) {
        bytes += '\3';
        for (const std::uint32_t vertex : triangle) {
            append_little(bytes, vertex);
        }
    }
    return bytes;
}

std::string encode_ply(const PointCloud& cloud) {
    constexpr std::size_t kMostPointSize = 27;
    std::string bytes = ply_header(cloud_comments(cloud));
    bytes += fmt::format(
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", cloud.size());
    if (!cloud.normals.empty()) {
        bytes += "property float nx\nproperty float ny\nproperty float nz\n";
    }
    if (!cloud.colors.empty()) {
        bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    }
    bytes += "end_header\n";
    bytes.reserve(bytes.size() + kMostPointSize * cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        append_little(bytes, cloud.points[i]);
        if (!cloud.normals.empty()) {
            append_little(bytes, cloud.normals[i]);
        }
        for (std::size_t c = 0; c < 3 && !cloud.colors.empty(); ++c) {
            append_little(bytes, cloud.colors[i][c]);
        }
    }
    return bytes;
}

}  // namespace ostraka
