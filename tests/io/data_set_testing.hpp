// SPDX-License-Identifier: Apache-2.0
// Helpers of the tests of data sets.
#pragma once

#include <cstdlib>

#include "io/io_testing.hpp"

namespace ostraka::io_testing {

inline const std::string kPose = "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n";  // of an .xf file
inline const std::string kPoint = "1 2 3\n";                              // of an .xyz file

/// save() that makes the folder.
inline void save_at(const std::filesystem::path& path, const std::string& text) {
    std::filesystem::create_directories(path.parent_path());
    save(path, text);
}

/// Data as others published it.
class RealDataSets : public ::testing::Test {
  protected:
    void SetUp() override {
        const char* data = std::getenv("OSTRAKA_DATA");
        if (data == nullptr) GTEST_SKIP() << "set OSTRAKA_DATA to a folder with uwa/ and bologna/";
        folder_ = data;
    }
    std::filesystem::path folder_;
};

}  // namespace ostraka::io_testing
