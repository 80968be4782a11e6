// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/settings_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <type_traits>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// One list of all settings serves both directions: a Writer or a Reader visits every field.
class Writer {
  public:
    template <class T>
    void operator()(const char* key, const T& value) {
        texts[key] = fmt::format("{}", value);
    }
    SettingTexts texts;
};

class Reader {
  public:
    explicit Reader(const SettingTexts& texts) : texts_(texts) {}

    template <class T>
    void operator()(const char* key, T& value) const {
        const std::string& text = find(key);
        if constexpr (std::is_same_v<T, bool>) {
            if (text != "true" && text != "false") fail(key, text);
            value = text == "true";
        } else {
            const char* end = text.data() + text.size();
            const auto [stop, problem] = std::from_chars(text.data(), end, value);
            if (problem != std::errc() || stop != end) fail(key, text);
        }
    }
    const std::string& find(const std::string& key) const {
        const auto it = texts_.find(key);
        if (it == texts_.end()) throw InvalidInput("setting " + key + " is missing");
        return it->second;
    }
    [[noreturn]] static void fail(const std::string& key, const std::string& text) {
        throw InvalidInput(fmt::format("setting {}: can't read \"{}\"", key, text));
    }

  private:
    const SettingTexts& texts_;
};

template <class Visitor, class Settings>
void visit_numbers(Visitor& visit, Settings& s) {
    visit("sampling", s.sampling);
    visit("views.count", s.views.count);
    visit("views.sampling", s.views.sampling);
    visit("views.distance", s.views.distance);
    visit("views.rays_per_sample", s.views.rays_per_sample);
    visit("views.sensor.noise", s.views.sensor.noise);
    visit("views.sensor.noise_per_depth2", s.views.sensor.noise_per_depth2);
    visit("views.sensor.quantization", s.views.sensor.quantization);
    visit("views.sensor.max_grazing_angle", s.views.sensor.max_grazing_angle);
    visit("views.sensor.seed", s.views.sensor.seed);
    visit("cuts.directions", s.cuts.directions);
    visit("cuts.cluster_tolerance", s.cuts.cluster_tolerance);
    visit("cuts.min_points", s.cuts.min_points);
    visit("cuts.min_share", s.cuts.min_share);
    visit("full_views_only", s.full_views_only);
    visit("selection.budget", s.selection.budget);
    visit("selection.max_overlap", s.selection.max_overlap);
    visit("selection.spread", s.selection.spread);
    visit("keypoint_spacing", s.keypoint_spacing);
    visit("keypoint_radius", s.keypoint_radius);
    visit("seed", s.seed);
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        parts.push_back(text.substr(start, comma - start));
        start = comma + 1;
    }
    return parts;
}

}  // namespace

SettingTexts to_text(const LibrarySettings& settings) {
    Writer writer;
    visit_numbers(writer, settings);
    writer.texts["unit"] = unit_name(settings.unit);
    writer.texts["selection.redundancy"] = redundancy_name(settings.selection.redundancy);
    std::string fractions;
    for (const double fraction : settings.cuts.fractions) {
        fractions += fmt::format("{}{}", fractions.empty() ? "" : ",", fraction);
    }
    writer.texts["cuts.fractions"] = fractions;
    std::string descriptors;
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        descriptors +=
            fmt::format("{}{}", descriptors.empty() ? "" : ",", descriptor_name(descriptor));
    }
    writer.texts["descriptors"] = descriptors;
    return writer.texts;
}

LibrarySettings settings_from_text(const SettingTexts& texts) {
    LibrarySettings settings;
    Reader reader(texts);
    visit_numbers(reader, settings);
    const std::optional<Unit> unit = parse_unit(reader.find("unit"));
    if (!unit) Reader::fail("unit", reader.find("unit"));
    settings.unit = *unit;
    const auto redundancy = parse_redundancy(reader.find("selection.redundancy"));
    if (!redundancy) Reader::fail("selection.redundancy", reader.find("selection.redundancy"));
    settings.selection.redundancy = *redundancy;
    if (settings.selection.spread < 0 || settings.selection.spread > kMostSpreadDirections) {
        Reader::fail("selection.spread", reader.find("selection.spread"));
    }
    settings.cuts.fractions.clear();
    for (const std::string& text : split(reader.find("cuts.fractions"))) {
        double fraction = 0.0;
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), fraction);
        if (parsed.ec != std::errc()) Reader::fail("cuts.fractions", text);
        settings.cuts.fractions.push_back(fraction);
    }
    settings.descriptors.clear();
    for (const std::string& name : split(reader.find("descriptors"))) {
        const std::optional<AnyDescriptor> descriptor = parse_descriptor(name);
        if (!descriptor) Reader::fail("descriptors", name);
        settings.descriptors.push_back(*descriptor);
    }
    return settings;
}

}  // namespace ostraka
