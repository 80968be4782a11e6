// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/build.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

using testing::quick_settings;
using testing::simple_models;

TEST(BuildLibrary, GivesEveryModelItsBudgetAndEveryEntryARow) {
    const ModelLibrary library = build_library(simple_models(), quick_settings());
    ASSERT_EQ(library.models.size(), 2U);
    EXPECT_EQ(library.entries.size(), 48U);
    ASSERT_EQ(library.tables.size(), 5U);
    for (const DescriptorTable& table : library.tables) {
        EXPECT_EQ(table.rows.size(), 48U * descriptor_length(table.descriptor));
        for (const float value : table.rows) ASSERT_TRUE(std::isfinite(value));
    }
    for (const Model& model : library.models) {
        const BuildCounts& c = model.counts;
        EXPECT_EQ(c.views, 20);
        EXPECT_EQ(c.cuts, 20 * 6 * 2);
        EXPECT_EQ(c.views + c.cuts, c.too_small + c.redundant + c.beyond_budget + c.kept);
        EXPECT_GT(c.coverage, 0.5);
        EXPECT_GT(model.keypoints.size(), 50U);
    }
}

TEST(BuildLibrary, EntriesLieOnTheirModel) {
    const ModelLibrary library = build_library(simple_models(), quick_settings());
    for (const Entry& entry : library.entries) {
        const Model& model = library.models[entry.model];
        const KdTree tree(model.surface.points);
        for (const Vec3f& point : entry.cloud.points) {
            EXPECT_LT(std::sqrt(tree.nearest(point).squared_distance), 3.0F);
        }
        const double distance = (entry.cloud.viewpoint.cast<double>() - model.shape.center).norm();
        EXPECT_NEAR(distance, 3.0 * model.shape.diameter, 0.01 * model.shape.diameter);
    }
}

TEST(BuildLibrary, FullViewsOnlyKeepsEveryViewAndNoCut) {
    LibrarySettings settings = quick_settings();
    settings.full_views_only = true;
    const ModelLibrary library = build_library(simple_models(), settings);
    EXPECT_EQ(library.entries.size(), 40U);
    for (const Entry& entry : library.entries) EXPECT_EQ(entry.direction, -1);
}

TEST(BuildLibrary, DescriptorsWithManyRowsAreRejected) {
    LibrarySettings settings = quick_settings();
    settings.descriptors = {VfhSettings{}, ShotSettings{}};
    EXPECT_THROW(build_library(simple_models(), settings), InvalidInput);
}

TEST(BuildLibrary, OrderOfModelsDoesNotMatter) {
    std::vector<ModelSource> models = simple_models();
    const ModelLibrary a = build_library(models, quick_settings());
    std::swap(models[0], models[1]);
    const ModelLibrary b = build_library(models, quick_settings());
    ASSERT_EQ(a.models[0].name, b.models[0].name);
    for (std::size_t t = 0; t < a.tables.size(); ++t) EXPECT_EQ(a.tables[t].rows, b.tables[t].rows);
}

TEST(BuildLibrary, TurningAModelTurnsItsEntries) {
    std::vector<ModelSource> models = simple_models();
    const ModelLibrary before = build_library(models, quick_settings());
    Pose T_new_old = Pose::Identity();
    T_new_old.linear() = Random(5).rotation();
    T_new_old.translation() = Vec3d(300.0, -100.0, 20.0);
    for (ModelSource& model : models) model.mesh = transformed(model.mesh, T_new_old);
    const ModelLibrary after = build_library(models, quick_settings());
    ASSERT_EQ(before.entries.size(), after.entries.size());
    // Rounding may tip a few points into another cell, and with them a choice between near equals.
    using Cut = std::tuple<std::uint32_t, int, int, int>;
    std::map<Cut, Vec3f> eyes;
    for (const Entry& a : before.entries) {
        eyes[{a.model, a.view, a.direction, a.fraction}] =
            Vec3d(T_new_old * a.cloud.viewpoint.cast<double>()).cast<float>();
    }
    std::size_t same = 0;
    for (const Entry& b : after.entries) {
        const auto found = eyes.find({b.model, b.view, b.direction, b.fraction});
        if (found == eyes.end()) continue;
        ++same;
        EXPECT_LT((found->second - b.cloud.viewpoint).norm(), 0.5F);
    }
    EXPECT_GE(same, before.entries.size() * 8 / 10);
}

TEST(BuildLibrary, RejectsWhatItCannotUse) {
    EXPECT_THROW(build_library({}, quick_settings()), InvalidInput);
    std::vector<ModelSource> twins = simple_models();
    twins[1].name = twins[0].name;
    EXPECT_THROW(build_library(twins, quick_settings()), InvalidInput);
    LibrarySettings settings = quick_settings();
    settings.views.count = 13;
    EXPECT_THROW(build_library(simple_models(), settings), InvalidInput);
    settings = quick_settings();
    settings.cuts.fractions = {1.5};
    EXPECT_THROW(build_library(simple_models(), settings), InvalidInput);
    settings = quick_settings();
    settings.sampling = 1e-6;
    EXPECT_THROW(build_library(simple_models(), settings), InvalidInput);
}

TEST(BuildLibrary, StopsWhenAsked) {
    const Progress stop = [](std::string_view, std::size_t done, std::size_t) { return done < 5; };
    EXPECT_THROW(build_library(simple_models(), quick_settings(), stop), Interrupted);
}

}  // namespace
}  // namespace ostraka
