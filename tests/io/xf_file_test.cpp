// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/xf_file.hpp"

#include "io/io_testing.hpp"
#include "mesh/test_meshes.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

// A pose of UWA's T-rex, as published.
const std::string kPublished =
    "0.986843 0.0105495 0.161341 -15.9453 \n"
    "-0.0349336 -0.960388 0.276469 185.037 \n"
    "0.157867 -0.278468 -0.947383 -1199.47 \n"
    "0 0 0 1 \n";

Pose parse(const std::string& text) {
    return parse_xf(bytes_of(text), "test.xf");
}

TEST(XfFile, ReadsWhatIsPublishedAndMakesItOrthonormal) {
    const Pose pose = parse(kPublished);
    EXPECT_EQ(pose.translation(), Eigen::Vector3d(-15.9453, 185.037, -1199.47));
    EXPECT_NEAR(pose(1, 2), 0.276469, 1e-5);
    const Mat3d rotation = pose.linear();
    EXPECT_LT((rotation * rotation.transpose() - Mat3d::Identity()).norm(), 1e-14);
}

TEST(XfFile, WritesWhatItReads) {
    const TestFolder folder;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        Pose pose = test_meshes::random_pose(seed);
        pose.translation() *= 1234.5;
        write_xf(folder / "pose.xf", pose);
        const Pose read = read_xf(folder / "pose.xf");
        EXPECT_EQ(read.translation(), pose.translation());
        EXPECT_LT((read.matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-14);
    }
    Pose bad = Pose::Identity();
    bad(0, 3) = std::nan("");
    EXPECT_THROW(write_xf(folder / "pose.xf", bad), InvalidInput);
    EXPECT_THROW(read_xf(folder / "none.xf"), FileError);
}

TEST(XfFile, LinesAndExponentsDoNotMatter) {
    std::string one_line = replaced(kPublished, "185.037", "+1.85037e2");
    std::replace(one_line.begin(), one_line.end(), '\n', '\t');
    EXPECT_EQ(parse(one_line).matrix(), parse(kPublished).matrix());
    const std::string dos = "1 0 0 1\r\n0 1 0 2\r\n0 0 1 3\r\n0 0 0 1";
    EXPECT_EQ(parse(dos).translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(XfFile, RejectsEveryTruncation) {
    const std::size_t last = kPublished.rfind('1');
    for (std::size_t length = 0; length <= last; ++length) {
        EXPECT_NE(problem_of(parse, kPublished.substr(0, length)), "") << length;
    }
}

TEST(XfFile, SaysWhatIsWrongAndWhere) {
    const auto problem = [](const std::string& from, const std::string& to) {
        return problem_of(parse, replaced(kPublished, from, to));
    };
    EXPECT_NE(problem("0.276469", "abc").find("line 2"), std::string::npos);
    EXPECT_NE(problem("0.276469", "abc").find("\"abc\" is not a number"), std::string::npos);
    EXPECT_NE(problem("0 0 0 1", "0 0 0 1 7").find("follows the 16"), std::string::npos);
    EXPECT_NE(problem("0 0 0 1", "0 0 0 2").find("last row"), std::string::npos);
    EXPECT_NE(problem("-0.960388", "-0.9").find("not a rotation"), std::string::npos);
    EXPECT_NE(problem("-0.960388", "nan").find("out of range"), std::string::npos);
    EXPECT_NE(problem("185.037", "inf").find("out of range"), std::string::npos);
    EXPECT_NE(problem("185.037", "1e10").find("out of range"), std::string::npos);
    EXPECT_NE(problem_of(parse, "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1").find("not a rotation"),
              std::string::npos);
    EXPECT_NE(problem_of(parse, "1 0 0").find("3 numbers"), std::string::npos);
}

}  // namespace
}  // namespace ostraka
