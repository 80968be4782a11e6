// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/bags.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/library/keypoint_index.hpp"

namespace ostraka {
namespace {

// Evenly from each model, so that a large one doesn't own all words.
std::vector<float> sample_keypoint_rows(const std::vector<Model>& models, std::size_t most) {
    const std::size_t share = std::max<std::size_t>(1, most / models.size());
    std::vector<float> rows;
    for (const Model& model : models) {
        const std::size_t count = model.keypoints.size();
        const std::size_t taken = std::min(share, count);
        for (std::size_t i = 0; i < taken; ++i) {
            const auto row = model.keypoints.rows.begin() +
                             static_cast<std::ptrdiff_t>(i * count / taken * kShotLength);
            rows.insert(rows.end(), row, row + static_cast<std::ptrdiff_t>(kShotLength));
        }
    }
    return rows;
}

// Entries are stored without normals; these are made as a segment's are.
PointCloud entry_cloud(const Entry& entry, double sampling) {
    PointCloud cloud = entry.cloud;
    cloud.normals = estimate_normals_within(cloud, kNormalRadius * sampling);
    return remove_invalid(cloud);
}

}  // namespace

std::vector<float> describe_bag(const PointCloud& cloud, const ModelLibrary& library,
                                std::size_t most) {
    const SceneKeypoints keypoints =
        scene_keypoints(cloud, library.settings, library.settings.keypoint_spacing, most);
    const std::vector<float> rows(keypoints.rows.begin(), keypoints.rows.end());
    return bag_of_words(rows, library.codebook);
}

void make_bags(ModelLibrary& library) {
    library.codebook = {};
    library.bags.clear();
    const CodebookSettings settings{.seed = library.settings.seed};
    const std::vector<float> rows = sample_keypoint_rows(library.models, settings.max_samples);
    if (std::all_of(rows.begin(), rows.end(), [](float value) { return value == 0.0F; })) return;
    library.codebook = learn_codebook(rows, kShotLength, settings);
    const std::size_t words = library.codebook.size();
    library.bags.resize(library.entries.size() * words);
    parallel_for(library.entries.size(), [&](std::size_t i) {
        const PointCloud cloud = entry_cloud(library.entries[i], library.settings.sampling);
        if (cloud.empty()) return;
        const std::vector<float> bag = describe_bag(cloud, library, kEntryBagKeypoints);
        std::copy(bag.begin(), bag.end(),
                  library.bags.begin() + static_cast<std::ptrdiff_t>(i * words));
    });
}

}  // namespace ostraka
