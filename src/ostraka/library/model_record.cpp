// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"
#include "ostraka/library/selection.hpp"

namespace ostraka {

ModelLibrary join_records(const LibrarySettings& settings, std::vector<ModelRecord> records) {
    std::sort(records.begin(), records.end(),
              [](const auto& a, const auto& b) { return a.model.name < b.model.name; });
    ModelLibrary library;
    library.settings = settings;
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        library.tables.push_back({descriptor, {}, {}});
    }
    for (ModelRecord& record : records) {
        const std::string& name = record.model.name;
        if (!library.models.empty() && library.models.back().name == name) {
            throw InvalidInput(fmt::format("two models are named {}: names must differ", name));
        }
        for (Entry& entry : record.entries) {
            entry.model = static_cast<std::uint32_t>(library.models.size());
            library.entries.push_back(std::move(entry));
        }
        for (std::size_t t = 0; t < library.tables.size(); ++t) {
            std::vector<float>& rows = library.tables[t].rows;
            rows.insert(rows.end(), record.rows[t].begin(), record.rows[t].end());
            library.tables[t].spread.append(record.spreads[t]);
        }
        library.models.push_back(std::move(record.model));
    }
    return library;
}

std::vector<ModelRecord> split_library(ModelLibrary library) {
    std::vector<ModelRecord> records(library.models.size());
    std::size_t first = 0;
    for (std::size_t m = 0; m < records.size(); ++m) {
        ModelRecord& record = records[m];
        record.model = std::move(library.models[m]);
        std::size_t last = first;
        for (; last < library.entries.size() && library.entries[last].model == m; ++last) {
            library.entries[last].model = 0;
            record.entries.push_back(std::move(library.entries[last]));
        }
        for (const DescriptorTable& table : library.tables) {
            const std::size_t length = descriptor_length(table.descriptor);
            record.rows.emplace_back(
                table.rows.begin() + static_cast<std::ptrdiff_t>(first * length),
                table.rows.begin() + static_cast<std::ptrdiff_t>(last * length));
            record.spreads.push_back(table.spread.part(first, last, length));
        }
        first = last;
    }
    return records;
}

ModelLibrary thin_library(const ModelLibrary& library, int budget) {
    std::vector<ModelRecord> thinned;
    for (const ModelRecord& record : split_library(library)) {
        ModelRecord fewer;
        fewer.model = record.model;
        fewer.rows.resize(record.rows.size());
        fewer.spreads.resize(record.spreads.size());
        for (const std::uint32_t e :
             thin_out(record.entries.size(), static_cast<std::size_t>(budget))) {
            fewer.entries.push_back(record.entries[e]);
            for (std::size_t t = 0; t < record.rows.size(); ++t) {
                const std::size_t length = record.rows[t].size() / record.entries.size();
                const auto row = record.rows[t].begin() + static_cast<std::ptrdiff_t>(e * length);
                fewer.rows[t].insert(fewer.rows[t].end(), row,
                                     row + static_cast<std::ptrdiff_t>(length));
                fewer.spreads[t].append(record.spreads[t].part(e, e + 1, length));
            }
        }
        thinned.push_back(std::move(fewer));
    }
    LibrarySettings settings = library.settings;
    settings.selection.budget = budget;
    return join_records(settings, std::move(thinned));
}

}  // namespace ostraka
