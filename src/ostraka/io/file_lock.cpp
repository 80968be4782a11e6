// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr mode_t kNewFile = 0666;

// A holder may have removed the file between our opening and locking it.
bool still_named(int descriptor, const std::filesystem::path& path) {
    struct stat ours = {};
    struct stat named = {};
    return ::fstat(descriptor, &ours) == 0 && ::stat(path.c_str(), &named) == 0 &&
           ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& path) {
    for (;;) {
        descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kNewFile);
        if (descriptor_ < 0) {
            throw FileError(path, "can't be written: " + std::generic_category().message(errno));
        }
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            const int error = errno;
            ::close(descriptor_);
            throw FileError(path,
                            error == EWOULDBLOCK
                                ? "another process is writing to it"
                                : "can't be locked: " + std::generic_category().message(error));
        }
        if (still_named(descriptor_, path)) return;
        ::close(descriptor_);
    }
}

FileLock::~FileLock() {
    ::close(descriptor_);
}

}  // namespace ostraka
