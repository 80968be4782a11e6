// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/settings_text.hpp"

namespace ostraka {
namespace {

// One model with all that belongs to it.
struct Part {
    Model model;
    std::vector<Entry> entries;
    std::vector<std::vector<float>> rows;  // per table
};

// Others are derived from these two, so they are named first.
void require_equal_settings(const LibrarySettings& a, const LibrarySettings& b) {
    const SettingTexts first = to_text(a);
    SettingTexts second = to_text(b);
    const auto require_equal = [&](const std::string& key) {
        if (first.at(key) == second[key]) return;
        throw InvalidInput(fmt::format("the libraries differ in the setting {}: {} and {}", key,
                                       first.at(key), second[key]));
    };
    require_equal("unit");
    require_equal("sampling");
    for (const auto& [key, value] : first) require_equal(key);
}

std::vector<Part> split(ModelLibrary library) {
    std::vector<Part> parts(library.models.size());
    for (std::size_t m = 0; m < parts.size(); ++m) {
        parts[m].model = std::move(library.models[m]);
        parts[m].rows.resize(library.tables.size());
    }
    for (std::size_t e = 0; e < library.entries.size(); ++e) {
        Part& part = parts[library.entries[e].model];
        part.entries.push_back(std::move(library.entries[e]));
        for (std::size_t t = 0; t < library.tables.size(); ++t) {
            const std::size_t length = descriptor_length(library.tables[t].descriptor);
            const auto row =
                library.tables[t].rows.begin() + static_cast<std::ptrdiff_t>(e * length);
            part.rows[t].insert(part.rows[t].end(), row, row + static_cast<std::ptrdiff_t>(length));
        }
    }
    return parts;
}

void require_distinct_names(const std::vector<Part>& sorted) {
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i].model.name != sorted[i - 1].model.name) continue;
        throw InvalidInput(
            fmt::format("two models are named {}: names must differ", sorted[i].model.name));
    }
}

// Models in the order of their names, as build_library() leaves them.
ModelLibrary join(const LibrarySettings& settings, std::vector<Part> parts, bool with_bags) {
    std::sort(parts.begin(), parts.end(),
              [](const Part& a, const Part& b) { return a.model.name < b.model.name; });
    require_distinct_names(parts);
    ModelLibrary library;
    library.settings = settings;
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        library.tables.push_back({descriptor, {}});
    }
    for (Part& part : parts) {
        for (Entry& entry : part.entries) {
            entry.model = static_cast<std::uint32_t>(library.models.size());
            library.entries.push_back(std::move(entry));
        }
        for (std::size_t t = 0; t < library.tables.size(); ++t) {
            std::vector<float>& rows = library.tables[t].rows;
            rows.insert(rows.end(), part.rows[t].begin(), part.rows[t].end());
        }
        library.models.push_back(std::move(part.model));
    }
    if (with_bags) make_bags(library);  // their words depend on all models
    return library;
}

Part& find_part(std::vector<Part>& parts, const std::string& name) {
    for (Part& part : parts) {
        if (part.model.name == name) return part;
    }
    throw InvalidInput(fmt::format("the library has no model named {}", name));
}

}  // namespace

ModelLibrary merge_libraries(std::vector<ModelLibrary> libraries) {
    if (libraries.empty()) throw InvalidInput("nothing to merge");
    const LibrarySettings settings = libraries.front().settings;
    const bool with_bags = libraries.front().codebook.size() > 0;
    std::vector<Part> all;
    for (ModelLibrary& library : libraries) {
        require_equal_settings(settings, library.settings);
        std::vector<Part> parts = split(std::move(library));
        std::move(parts.begin(), parts.end(), std::back_inserter(all));
    }
    return join(settings, std::move(all), with_bags);
}

ModelLibrary add_models(ModelLibrary library, std::span<const ModelSource> models,
                        const Progress& progress) {
    for (const ModelSource& source : models) {
        for (const Model& model : library.models) {
            if (model.name != source.name) continue;
            throw InvalidInput(
                fmt::format("the library has a model named {} already: remove or rename it first",
                            source.name));
        }
    }
    std::vector<ModelLibrary> both;
    both.push_back(std::move(library));
    both.push_back(build_library(models, both.front().settings, progress));
    return merge_libraries(std::move(both));
}

ModelLibrary remove_model(ModelLibrary library, const std::string& name) {
    const LibrarySettings settings = library.settings;
    const bool with_bags = library.codebook.size() > 0;
    std::vector<Part> parts = split(std::move(library));
    find_part(parts, name);
    if (parts.size() == 1) throw InvalidInput("a library needs at least one model");
    std::erase_if(parts, [&](const Part& part) { return part.model.name == name; });
    return join(settings, std::move(parts), with_bags);
}

ModelLibrary rename_model(ModelLibrary library, const std::string& from, const std::string& to) {
    if (to.empty()) throw InvalidInput("a model's name must not be empty");
    const LibrarySettings settings = library.settings;
    const bool with_bags = library.codebook.size() > 0;
    std::vector<Part> parts = split(std::move(library));
    find_part(parts, from).model.name = to;
    return join(settings, std::move(parts), with_bags);
}

}  // namespace ostraka
