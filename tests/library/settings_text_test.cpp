// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/settings_text.hpp"

#include <gtest/gtest.h>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

LibrarySettings unusual() {
    LibrarySettings settings;
    settings.unit = Unit::inch;
    settings.sampling = 0.1;
    settings.views.count = 80;
    settings.views.sensor.seed = 0xffffffffffffffffULL;
    settings.cuts.fractions = {0.3333333333333333, 0.9};
    settings.full_views_only = true;
    settings.selection.budget = 7;
    settings.descriptors = {EsfSettings{}, VfhSettings{}};
    return settings;
}

TEST(SettingsText, ReadsBackExactly) {
    const LibrarySettings settings = unusual();
    const LibrarySettings back = settings_from_text(to_text(settings));
    EXPECT_EQ(to_text(back), to_text(settings));
    EXPECT_EQ(back.cuts.fractions, settings.cuts.fractions);
    EXPECT_EQ(back.views.sensor.seed, settings.views.sensor.seed);
    EXPECT_EQ(back.unit, Unit::inch);
    EXPECT_TRUE(back.full_views_only);
    ASSERT_EQ(back.descriptors.size(), 2U);
    EXPECT_EQ(descriptor_name(back.descriptors[0]), "esf");
}

TEST(SettingsText, EverySettingIsNeeded) {
    const SettingTexts texts = to_text(LibrarySettings{});
    for (const auto& [key, value] : texts) {
        SettingTexts without = texts;
        without.erase(key);
        EXPECT_THROW(settings_from_text(without), InvalidInput) << key;
        SettingTexts broken = texts;
        broken[key] = std::string(1, '?');
        EXPECT_THROW(settings_from_text(broken), InvalidInput) << key;
    }
}

}  // namespace
}  // namespace ostraka
