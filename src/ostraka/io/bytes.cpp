// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bytes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// One read() moves at most about 2 GB on Linux.
constexpr std::size_t kMostPerRead = std::size_t{1} << 30;

std::string reason() {
    return std::generic_category().message(errno);
}

struct Descriptor {
    int value = -1;
    ~Descriptor() {
        if (value >= 0) {
            ::close(value);
        }
    }
};

}  // namespace

FileBytes read_file(const std::filesystem::path& path, std::size_t most) {
    // Not blocking: opening a pipe without a writer must not hang before its kind is known.
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    struct stat info = {};
    if (file.value < 0 || ::fstat(file.value, &info) != 0) {
        throw FileError(path, "can't be opened: " + reason());
    }
    if (!S_ISREG(info.st_mode)) {
        throw FileError(path, S_ISDIR(info.st_mode) ? "is a folder" : "is not a regular file");
    }
    FileBytes bytes;
    const std::size_t size = std::min(static_cast<std::size_t>(info.st_size), most);
    bytes.data = std::make_unique_for_overwrite<char[]>(size);
    while (bytes.size < size) {
        const ssize_t count = ::read(file.value, bytes.data.get() + bytes.size,
                                     std::min(size - bytes.size, kMostPerRead));
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count < 0) {
            throw FileError(path, "can't be read: " + reason());
        }
        if (count == 0) {
            break;  // someone shortened it meanwhile; the parser will say what is missing
        }
        bytes.size += static_cast<std::size_t>(count);
    }
    return bytes;
}

void write_plain_file(const std::filesystem::path& path, std::string_view bytes) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw FileError(path, "can't be written");
}

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return extension;
}

void append_fan(std::span<const std::uint32_t> polygon, std::vector<Triangle>& triangles) {
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
}

void check_indices(const TriangleMesh& mesh, const std::filesystem::path& path) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            if (vertex >= mesh.vertices.size()) {
                throw FormatError(
                    path, fmt::format("triangle {}", i),
                    fmt::format("names vertex {}, but there are {}", vertex, mesh.vertices.size()));
            }
        }
    }
}

}  // namespace ostraka
