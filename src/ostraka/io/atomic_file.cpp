// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// One write() moves at most about 2 GB on Linux.
constexpr std::size_t kMostPerWrite = std::size_t{1} << 30;
constexpr mode_t kPermissionBits = 07777;
constexpr mode_t kNewFile = 0666;
// A file's name may have 255 bytes; the temporary's adds a dot and a suffix.
constexpr std::size_t kLongestName = 200;

std::string reason(int error) {
    return std::generic_category().message(error);
}

// Temporaries are locked as long as their process lives, so one that can be locked was left behind
// by a kill. Best effort: litter is no reason to fail.
void remove_litter(const std::filesystem::path& target, const std::string& name) {
    std::error_code ignored;
    const std::filesystem::path folder =
        target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
    for (const auto& item : std::filesystem::directory_iterator(folder, ignored)) {
        const std::string found = item.path().filename().string();
        if (!found.starts_with("." + name + ".") || !found.ends_with(".tmp")) continue;
        const int descriptor = ::open(item.path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor < 0) continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(item.path().c_str());
        ::close(descriptor);
    }
}

// The first free name beside `target`.
std::filesystem::path make_temporary(const std::filesystem::path& target, int& descriptor) {
    const std::string name = target.filename().string().substr(0, kLongestName);
    remove_litter(target, name);
    for (int i = 0;; ++i) {
        const std::string number = std::to_string(::getpid()) + "-" + std::to_string(i);
        std::filesystem::path temporary =
            target.parent_path() / ("." + name + "." + number + ".tmp");
        descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFile);
        if (descriptor < 0) {
            if (errno == EEXIST) continue;
            return temporary;
        }
        // Another process may take it for litter before it is locked: then it has no name anymore.
        struct stat info = {};
        static_cast<void>(::flock(descriptor, LOCK_EX | LOCK_NB) == 0);
        if (::fstat(descriptor, &info) != 0 || info.st_nlink > 0) return temporary;
        ::close(descriptor);
    }
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : named_(target), target_(target) {
    std::error_code ignored;
    if (std::filesystem::is_symlink(target, ignored)) {
        target_ = std::filesystem::weakly_canonical(target, ignored);
    }
    struct stat info = {};
    const bool exists = ::stat(target_.c_str(), &info) == 0;
    if (exists && !S_ISREG(info.st_mode)) {
        throw FileError(named_, S_ISDIR(info.st_mode) ? "can't be written: it is a folder"
                                                      : "can't be written: not a regular file");
    }
    if (exists && ::access(target_.c_str(), W_OK) != 0) {
        throw FileError(named_, "can't be written: " + reason(errno));
    }
    const std::filesystem::path temporary = make_temporary(target_, descriptor_);
    if (descriptor_ < 0) {
        throw FileError(named_, "can't be written: " + reason(errno));
    }
    temporary_ = temporary;
    if (exists) {
        // Best effort: a file system without permissions is no reason to fail.
        static_cast<void>(::fchmod(descriptor_, info.st_mode & kPermissionBits) == 0);
    }
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
    }
}

void AtomicFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count =
            ::write(descriptor_, bytes.data(), std::min(bytes.size(), kMostPerWrite));
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count < 0) {
            throw FileError(named_, "can't be written: " + reason(errno));
        }
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
}

void AtomicFile::commit() {
    if (::fsync(descriptor_) != 0) {
        throw FileError(named_, "can't be written: " + reason(errno));
    }
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) {
        throw FileError(named_, "can't be written: " + reason(errno));
    }
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
        throw FileError(named_, "can't be replaced: " + reason(errno));
    }
    temporary_.clear();
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace ostraka
