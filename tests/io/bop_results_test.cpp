// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bop_results.hpp"

#include "io/io_testing.hpp"
#include "mesh/test_meshes.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

const std::string kRow = "1,3,8,0.75,1 0 0 0 0 -1 0 1 0,10.5 -20 1e3,2.25";
const std::string kNames = "scene_id,im_id,obj_id,score,R,t,time\n";

std::vector<BopResult> parse(const std::string& text) {
    return parse_bop_results(bytes_of(text), "results.csv");
}

TEST(BopResults, ReadsRows) {
    const std::vector<BopResult> results = parse(kNames + kRow + "\r\n\n" + kRow);
    ASSERT_EQ(results.size(), 2U);
    const BopResult& result = results[1];
    EXPECT_EQ(result.scene, 1);
    EXPECT_EQ(result.image, 3);
    EXPECT_EQ(result.object, 8);
    EXPECT_EQ(result.score, 0.75);
    EXPECT_EQ(result.T_camera_model.translation(), Eigen::Vector3d(10.5, -20, 1000));
    EXPECT_NEAR(result.T_camera_model(1, 2), -1.0, 1e-15);
    EXPECT_EQ(result.seconds, 2.25);
    EXPECT_EQ(parse(kRow).size(), 1U);
    EXPECT_EQ(parse(kNames).size(), 0U);
    EXPECT_EQ(parse("").size(), 0U);
    EXPECT_EQ(parse(replaced(kRow, "2.25", " -1 "))[0].seconds, -1.0);
}

TEST(BopResults, WritesWhatItReads) {
    std::vector<BopResult> results;
    for (int i = 0; i < 40; ++i) {
        BopResult result{.scene = i, .image = 7 * i, .object = i + 1, .score = i / 7.0};
        result.T_camera_model = test_meshes::random_pose(static_cast<std::uint64_t>(i), 1234.5);
        result.seconds = 1.0 / (i + 1);
        results.push_back(result);
    }
    const TestFolder folder;
    write_bop_results(folder / "r.csv", results);
    EXPECT_TRUE(load_text(folder / "r.csv").starts_with(kNames));
    const std::vector<BopResult> read = read_bop_results(folder / "r.csv");
    ASSERT_EQ(read.size(), results.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].scene, results[i].scene);
        EXPECT_EQ(read[i].image, results[i].image);
        EXPECT_EQ(read[i].object, results[i].object);
        EXPECT_EQ(read[i].score, results[i].score);
        EXPECT_EQ(read[i].seconds, results[i].seconds);
        EXPECT_EQ(read[i].T_camera_model.translation(), results[i].T_camera_model.translation());
        EXPECT_LT((read[i].T_camera_model.linear() - results[i].T_camera_model.linear()).norm(),
                  1e-14);
    }
}

TEST(BopResults, RejectsWhatCanNotBeWritten) {
    const TestFolder folder;
    std::vector<BopResult> results(1);
    results[0].score = std::nan("");
    EXPECT_THROW(write_bop_results(folder / "r.csv", results), InvalidInput);
    results[0] = {.object = 0};
    EXPECT_THROW(write_bop_results(folder / "r.csv", results), InvalidInput);
    EXPECT_FALSE(std::filesystem::exists(folder / "r.csv"));
}

TEST(BopResults, RejectsEveryTruncationThatLosesAColumn) {
    // A cut within the last number can't be told from a shorter number.
    const std::string valid = kNames + kRow;
    const std::size_t last = valid.rfind(',');
    for (std::size_t length = 1; length <= last + 1; ++length) {
        const bool names_only = length == kNames.size() - 1 || length == kNames.size();
        EXPECT_EQ(problem_of(parse, valid.substr(0, length)).empty(), names_only) << length;
    }
}

TEST(BopResults, SurvivesDamage) {
    const auto survives_once = [](const std::string& text) {
        try {
            for (const BopResult& result : parse(text)) {
                EXPECT_TRUE(result.T_camera_model.matrix().allFinite());
            }
        } catch (const FormatError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    };
    std::uint64_t state = 1;
    for (int i = 0; i < 3000; ++i) {
        std::string text = kNames + kRow;
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        text[(state >> 33U) % text.size()] = static_cast<char>(state >> 20U);
        survives_once(text);
    }
}

TEST(BopResults, SaysWhatIsWrongAndWhere) {
    const auto problem = [](const std::string& from, const std::string& to) {
        return problem_of(parse, kNames + kRow + "\n" + replaced(kRow, from, to));
    };
    EXPECT_NE(problem("1,3", "x,3").find("line 3"), std::string::npos);
    EXPECT_NE(problem("1,3", "x,3").find("\"scene_id\" is not a whole"), std::string::npos);
    EXPECT_NE(problem("1,3", "1 2,3").find("scene_id"), std::string::npos);
    EXPECT_NE(problem("1,3", "1,-3").find("im_id"), std::string::npos);
    EXPECT_NE(problem(",8,", ",0,").find("obj_id"), std::string::npos);
    EXPECT_NE(problem("0.75", "nan").find("score"), std::string::npos);
    EXPECT_NE(problem("0.75", "").find("score"), std::string::npos);
    EXPECT_NE(problem("1 0 0 0 0", "1 0 0 0").find("\"R\""), std::string::npos);
    EXPECT_NE(problem("1 0 0 0 0", "1 0 0 0 0 0").find("too many"), std::string::npos);
    EXPECT_NE(problem("1 0 0 0 0", "1 0 0 0 0.5").find("not a rotation"), std::string::npos);
    EXPECT_NE(problem("10.5 -20 1e3", "10.5 -20").find("\"t\""), std::string::npos);
    EXPECT_NE(problem("1e3", "1e30").find("\"t\""), std::string::npos);
    EXPECT_NE(problem(",2.25", "").find("has no \"time\""), std::string::npos);
    EXPECT_NE(problem("2.25", "2.25,").find("more than 7"), std::string::npos);
}

}  // namespace
}  // namespace ostraka
