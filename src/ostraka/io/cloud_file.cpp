// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/cloud_file.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/pcd.hpp"
#include "ostraka/io/ply.hpp"
#include "ostraka/io/xyz.hpp"

namespace ostraka {
namespace {

struct CloudFormat {
    const char* extension;
    CloudFile (*parse)(std::span<const char>, const std::filesystem::path&);
    std::string (*encode)(const PointCloud&);
};

constexpr CloudFormat kFormats[] = {
    {".ply", parse_ply_cloud, encode_ply}, {".pcd", parse_pcd, encode_pcd},
    {".xyz", parse_xyz, encode_xyz},       {".txt", parse_xyz, encode_xyz},
    {".asc", parse_xyz, encode_xyz},
};

const CloudFormat& find_format(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    for (const CloudFormat& format : kFormats) {
        if (extension == format.extension) {
            return format;
        }
    }
    throw InvalidInput(
        fmt::format("{}: not a known cloud format (.ply .pcd .xyz .txt .asc)", path.string()));
}

}  // namespace

CloudFile read_cloud_file(const std::filesystem::path& path) {
    const CloudFormat& format = find_format(path);
    return format.parse(read_file(path).span(), path);
}

PointCloud read_cloud(const std::filesystem::path& path) {
    return read_cloud_file(path).cloud;
}

void write_cloud(const std::filesystem::path& path, const PointCloud& cloud) {
    const CloudFormat& format = find_format(path);
    check(cloud);
    write_file_atomically(path, format.encode(cloud));
}

}  // namespace ostraka
